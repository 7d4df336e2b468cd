//! Masks, choices, reductions, braces and grids in programs.

use crate::common::{ids, number, open, sound};

/// Each is a program whose assertions hold.
#[test]
fn arrays_are_compared_chosen_and_reduced() {
    for program in [
        // Several arguments are combined element by element, one is reduced.
        "farray a = uniform(-1, 1, 5); a = max(a, 0);
         assert a[1] == 0 and a[2] == 0 and a[3] == 0 and a[4] == 0.5 and a[5] == 1;
         assert max(a) == 1 and min(a) == 0 and sum(a) == 1.5;",
        "farray a = min(list(3, 1, 5), list(2, 4, 6)); assert a[1] == 2 and a[2] == 1 and a[3] == 5;",
        "surface s[2,3]; s = {1, 2, 3}; s[1,2] = {7, -8, 9}; s.x = max(s.x, 5); s.y = min(s.y, 0);
         assert s[1,2].x == 7 and s[2,1].x == 5 and s[1,2].y == -8 and s[2,3].y == 0;",
        "assert max(3, 1) == 3 and max(3, 1, 7, 2) == 7 and max({1, 5, 2}) == 5;",
        "vector v = max({1, 5, 2}, 3); assert v.x == 3 and v.y == 5 and v.z == 3;",
        "assert max({1, 5, 2, 4}) == 5 and sum({1, 2, 3, 4}) == 10 and average({1, 2, 3, 6}) == 3;",
        // Comparisons are masks.
        "farray a = list(1, 2, 3, 4); farray m = a > 2; assert m[1] == 0 and m[3] == 1 and sum(m) == 2;
         assert any(a > 3) and not any(a > 4) and all(a > 0) and not all(a > 1);",
        "farray a = list(1, 2, 3, 4); assert sum(a > 1 and a < 4) == 2 and sum(a < 2 or a > 3) == 2;
         assert sum(not (a > 1)) == 1 and sum(a == list(1, 0, 3, 0)) == 2 and sum(a != 1) == 3;",
        "farray a = list(-1, 2, -3, 4); assert sum(where(a > 0, a, 0)) == 6;
         assert where(1, 5, 6) == 5 and where(0, 5, 6) == 6;",
        "curve c = uniform(0, 1, 3) * {1, 0, 0}; c = where(c.x > 0.2, c, {9, 9, 9});
         assert c[1].x == 9 and c[2].x == 0.5;",
        "assert sum(clamp(list(-1, 0.5, 3), 0, 1)) == 1.5 and clamp(7, 0, 1) == 1;",
        // Masks and indices select.
        "farray a = list(5, 1, 7); farray b = a[a > 4]; assert b.d1 == 2 and b[2] == 7;
         farray k = find(a > 4); assert k[1] == 1 and k[2] == 3; farray d = a[k]; assert d[2] == 7;",
        "curve c = uniform(0, 1, 5) * {1, 2, 0}; curve d = c[c.x > 0.4]; assert d.d1 == 3 and d[1].y == 1;",
        "farray a = list(5, 1, 7); farray b = a[list(3, 3, 1)]; assert b[1] == 7 and b[2] == 7 and b[3] == 5;",
        "surface s[3,2]; s[2,] = {1, 1, 1}; s[1,] = {0, 0, 0}; s[3,] = {2, 2, 2};
         surface t = s[list(3, 1)]; assert t.d1 == 2 and t[1,1].x == 2 and t[2,2].x == 0;",
        // Rows sorted, summed, differenced, interpolated.
        "farray a = sort(list(3, 1, 2)); assert a[1] == 1 and a[2] == 2 and a[3] == 3;
         farray s = cumsum(a); assert s[2] == 3 and s[3] == 6; farray d = diff(s); assert d[1] == 2 and d[2] == 3;",
        "farray y = interp(list(-1, 0.5, 1.5, 9), list(0, 1, 2), list(0, 10, 30));
         assert y[1] == 0 and y[2] == 5 and y[3] == 20 and y[4] == 30;",
        "surface s[2,3]; s[1,] = uniform(1, 3, 3) * {1, 0, 0}; s[2,] = uniform(4, 6, 3) * {1, 0, 0};
         farray i = sum(s.x, axis = 1); farray j = sum(s.x, axis = 2); farray m = average(s.x, axis = 1);
         assert i.d1 == 3 and i[1] == 5 and i[3] == 9 and j.d1 == 2 and j[2] == 15 and m[2] == 3.5;
         assert sum(max(s.x, axis = 2)) == 9;",
        // Braces are arrays where an operator stands.
        "farray a = uniform(1, 4, 4); farray b = a * {1, 2, 3, 4}; assert b[4] == 16 and sum({1, 2} * 2) == 6;",
        "curve c = {{0, 0, 0}, {1, 1, 1}} + {1, 0, 0}; assert c.d1 == 2 and c[2].x == 2 and c[2].y == 1;",
        "farray a = -{1, 2, 3, 4}; assert a[4] == -4;",
        // Scalars are as before.
        "assert (1 > 0 and 2 > 1) and not (1 > 2) and (1 > 2 or 2 > 1); int k = 0; if (1 > 2 and foo(1)) k = 1;
         function float foo(float x) { return 1 / 0; } assert k == 0;",
    ] {
        sound(program);
    }
}

#[test]
fn what_has_no_meaning_is_refused_with_a_place() {
    for (program, id) in [
        ("farray a = list(1, 2) > list(1, 2, 3);", "shapes-differ"),
        ("farray a = max(list(1, 2), list(1, 2, 3));", "shapes-differ"),
        ("if (list(1, 2) > 1) print 1;", "wrong-condition"),
        ("curve c = {{0, 0, 0}, {1, 1, 1}}; farray m = c > 1;", "wrong-operand"),
        ("farray a = list(1, 2); farray b = a[list(1, 3)];", "outside"),
        ("farray a = list(1, 2); farray b = a[list(1.5, 2)];", "outside"),
        ("farray a = clamp(list(1, 2), 3, 1);", "out-of-range"),
        ("farray a = interp(1, list(0, 0), list(1, 2));", "not-monotone"),
        ("farray a = where(list(1, 0), list(1, 2, 3), 0);", "shapes-differ"),
        ("farray a = where(list(1, 0), {1, 2, 3}, 0);", "wrong-class"),
        ("farray a = diff(list(1, 1, 1))[2:1];", "empty-range"),
        ("float x = sum(list(1, 2), axis = 1);", "wrong-shape"),
    ] {
        let document = open(program);
        assert!(ids(&document).iter().any(|found| found == id), "{program}: {:?}", ids(&document));
    }
}

/// The figures that the findings of users asked for.
#[test]
fn marched_sections_keep_their_first_cell() {
    let mut document = sound(
        "load \"naca.sdl\"
         curve c[81]; naca4s(c, 0, 0, 12); c = c[::-1];
         farray h = geometric(0, 20, 1e-3, 40);
         surface g = hyperbolic(c, h, \"i1 periodic\");
         float f = folds(g);
         farray w = |g[2,] - g[1,]|;
         float low = min(w), high = max(w), bad = min(quality(g, \"sj\"));",
    );
    assert_eq!(number(&mut document, "f"), 0.0);
    assert!((number(&mut document, "low") - 1e-3).abs() < 1e-12);
    assert!((number(&mut document, "high") - 1e-3).abs() < 1e-12);
    assert!(number(&mut document, "bad") > 0.1);
}

#[test]
fn smoothing_and_marching_say_what_they_left() {
    let document = open(
        "load \"stdsubs.sdl\"
         surface s[31,41]; arc(s[,1], PI, 0, 1); arc(s[,41], PI, 0, 6); line(s[1,]); line(s[31,]); transfinite(s);
         surface a = elliptic(s, 3, 1e-14);",
    );
    assert_eq!(ids(&document), ["not-converged"]);
    let document = open(
        "curve c = points({-1, 0, 0}, {-0.5, 0, 0}, {0, 0, 0}, {0, 0.5, 0}, {0, 1, 0});
         surface g = hyperbolic(c, list(0, 0.7, 1));",
    );
    assert_eq!(ids(&document), ["tight-corner"]);
    let document = open(
        "load \"stdsubs.sdl\"
         curve c[65]; arc(c, 0, 2*PI, 1); c[65] = c[1]; farray h = geometric(0, 1.2, 0.01, 30);
         surface g = hyperbolic(c, h, \"i1 periodic\", stop = \"keep\"); assert folds(g) == 0;",
    );
    assert_eq!(ids(&document), ["stopped-early"]);
}

/// Layers of a marched grid are a block of a file.
#[test]
fn marched_blocks_are_written() {
    let document = sound(
        "surface b[5,4]; for (i = 1:5) for (j = 1:4) b[i,j] = {i, j, 0};
         write_p3d(\"v.x\", \"text\", hyperbolic(b, list(0, 1, 2)));
         write_vts(\"v.vts\", hyperbolic(b, list(0, 1, 2)));",
    );
    let (_, bytes) = document.written().find(|(name, _)| *name == "v.x").expect("the file");
    let text = String::from_utf8(bytes.to_vec()).unwrap();
    let head: Vec<&str> = text.split_whitespace().take(4).collect();
    assert_eq!(head, ["1", "5", "4", "3"]);
}
