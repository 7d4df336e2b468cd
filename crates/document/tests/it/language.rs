//! What the language says of programs: code that is not executed, names, whole numbers, blocks.

use crate::common::{ids, number, open, sound};

/// Each program raises these ids and no others.
#[test]
fn code_that_is_not_executed_is_judged() {
    for (program, wanted) in [
        ("subroutine f(float a) { foo(a); curve c = 5; }", &["unknown-name", "wrong-type"][..]),
        ("if (0) foo(1);", &["unknown-name"]),
        ("function float f(float a) { return a + bb; }", &["unknown-name"]),
        ("subroutine f() { f(1); }", &["too-many-arguments"]),
        ("subroutine f() { Pointt P(1, 2, 3); }", &["unknown-entity"]),
        ("subroutine f() { curv c[3]; }", &["unknown-type"]),
        ("subroutine f() { curve c[3], d[4]; c = d; }", &["shapes-differ"]),
        ("function float f(float a) { if (a > 0) return 1; }", &["missing-return"]),
        ("function float f(float a) { return 1; print 2; }", &["unreachable"]),
        ("float a = 1; float a = 2;", &["declared-again"]),
        ("float t = 1; subroutine f() { float t = 2; print t; }", &["shadowed"]),
        ("function float sin(float x) { return 42; }", &["redefined"]),
        ("float PI = 3;", &["redefined"]),
        // What is right stays without a word, also when it is declared later.
        (
            "subroutine f() { print later(2), top; } function float later(float x) { return x; } float top = 1;",
            &[],
        ),
        ("for (i = 1:2) { float t = i; } for (i = 1:2) { float t = 2*i; }", &[]),
        ("function float f(float a) { while (1) { a += 1; if (a > 9) return a; } }", &[]),
        (
            "subroutine f() { AbsPoint P(1, 2, 3); leg l(P); print l.tip; } \
          subroutine leg(AbsPoint p) { RelPoint tip(p, 0, 0, 1); }",
            &[],
        ),
    ] {
        assert_eq!(ids(&open(program)), wanted, "{program}");
    }
}

#[test]
fn ints_are_exact() {
    assert_eq!(ids(&open("int i = 9007199254740993;")), ["int-overflow"]);
    assert_eq!(ids(&open("int i = 1; for (k = 1:60) i *= 2;")), ["int-overflow"]);
    assert_eq!(number(&mut sound("int i = 9007199254740991;"), "i"), 9_007_199_254_740_991.0);
}

/// Points of a block, and what its sections are.
#[test]
fn blocks_have_sections() {
    for program in [
        "block b[3,4,5]; assert b.d1 == 3 and b.d2 == 4 and b.d3 == 5;",
        "block b[2,3,4]; for (i = 1:2) for (j = 1:3) for (k = 1:4) b[i,j,k] = {i, j, k};
         assert b[2,3,4] . {1, 10, 100} == 432;
         surface s = b[,,2]; assert s.d1 == 2 and s.d2 == 3 and s[2,3].z == 2;
         surface t = b[1,,]; assert t.d1 == 3 and t.d2 == 4 and t[3,2] . {1, 10, 100} == 231;
         surface u = b[,2,]; assert u.d1 == 2 and u.d2 == 4 and u[2,4] . {1, 10, 100} == 422;
         curve c = b[1,,3]; assert c.d1 == 3 and c[2] . {1, 10, 100} == 321;
         curve d = b[2,3,2:4]; assert d.d1 == 3 and d[3].z == 4;
         block e = b[,1:3:2,::-1]; assert e.d2 == 2 and e[1,2,1] . {1, 10, 100} == 431;
         surface l = b[3]; assert l[1,1].z == 3;
         assert sum(b.x) == 36 and max(b.z) == 4 and min(b[1,,].y) == 1;
         block m = 2*b - {1, 1, 1}; assert m[2,3,4].z == 7 and (b - b)[1,1,1].x == 0 and sum(|b - b|) == 0;
         b[1,,] = {0, 0, 0}; assert b[1,2,2].y == 0 and b[2,2,2].y == 2;
         b[,,1] = s; assert b[2,1,1].z == 2; b[,,1].z = 7; assert b[1,1,1].z == 7;
         b[2,,3] = c; assert b[2,1,3].x == 1; b[,3,] *= 2; assert b[2,3,2].y == 6;
         b = {1, 2, 3}; assert b[2,2,2].y == 2;",
        "block b[2,2,2]; b = translate(b, {1, 2, 3}); assert b[2,2,2].y == 2; block c = scale(b, 2); assert c[1,1,1].z == 6;",
        "float s = 0; foreach (x in {1, 2, 3}) s += x; assert s == 6;",
        "farray a = max(list(1, 2, 3), {2, 2, 2}); assert a[1] == 2 and a[3] == 3;",
        // Parts are passed by reference.
        "load \"stdsubs.sdl\" block b[3,3,3]; b[3,1,1] = {2, 0, 0}; line(b[,1,1]); assert b[2,1,1].x == 1;
         subroutine lift(returned block b, returned surface s) { b.z = 1; s.x = 9; }
         block c[2,2,2]; lift(c, b[,,2]); assert c[1,2,2].z == 1 and b[1,1,2].x == 9 and b[1,1,3].x == 0;",
        "surface s[2,2] = {1, 2, 3}; block b = {s, 2*s, 3*s}; assert b.d3 == 3 and b[1,1,3].x == 3;",
    ] {
        sound(program);
    }
    for (program, id) in [
        ("block b[2,3,4]; surface s[2,2]; b[,,1] = s;", "shapes-differ"),
        ("block b[2,3,4]; block c[2,3,5]; b = c;", "shapes-differ"),
        ("block b[2,3,4]; block c[2,3,5]; block d = b + c;", "shapes-differ"),
        ("block b[2,3,4]; print b[1,1,5];", "outside"),
        ("block b[2,3,4]; print b[1,1];", "wrong-subscripts"),
        ("block b[2,3,4]; b[,,1] = \"a\";", "wrong-type"),
        ("surface s[2,2]; block b = s;", "wrong-type"),
        ("block b[2,3];", "wrong-dimension"),
    ] {
        assert!(
            ids(&open(program)).iter().any(|found| found == id),
            "{program}: {:?}",
            ids(&open(program))
        );
    }
}
