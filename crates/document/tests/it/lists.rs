//! Declared lists, records, arguments with values of their own, and `and` and `or` by type.

use crate::common::{ids, number, open, reported};
use moldloft_document::Document;

fn sound(text: &str) -> Document {
    let document = open(text);
    assert!(!document.has_errors(), "{}\n{text}", reported(&document).join("\n"));
    document
}

/// The numbers that expressions are, `true` as 1.
fn check(text: &str, wanted: &[(&str, f64)]) {
    let mut document = sound(text);
    for (expression, wanted) in wanted {
        assert_eq!(number(&mut document, expression), *wanted, "{expression}\n{text}");
    }
}

fn refused(text: &str, id: &str) {
    let document = open(text);
    assert!(ids(&document).iter().any(|found| found == id), "{:?}\n{text}", reported(&document));
}

const GRID: &str = "surface g[3,3]; for (i=1:3) for (j=1:3) g[i,j] = {i, j, 0};\n";

/// Members of records are known by their declarations, wherever the record comes from.
#[test]
fn numbers_beside_masks_of_members_give_masks() {
    let text = "record rib { float chord = 1; farray y[3] = 2; curve x[3]; } record wing { rib ribs[2]; }
                rib r, many[2]; wing w; int one = 1, none = 0;
                function rib made(float c) { return rib(c); } subroutine f(returned rib q) { q.y[one or q.y > 3] = 7; }
                farray a[3]; a[one or r.y > 3] = 1; farray b[3]; b[none and w.ribs[2].y > 1] = 1;
                farray c = (one or made(2).y > 3), d = (none and many[1].x.x < 1), e = (one or w.ribs[1].y > 3);
                farray g = (none and rib(3).y > 1); float s = (one and r.chord > 0), t = (none and r.y[1/0] > 0);
                foreach (q in many) { a += (one or q.y > 5); } f(r);";
    let one = |e: &str| format!("sum({e})");
    let wanted = [("a", 9.0), ("b", 0.0), ("c", 3.0), ("d", 0.0), ("e", 3.0), ("g", 0.0)];
    let mut document = sound(text);
    for (name, wanted) in wanted {
        assert_eq!(number(&mut document, &one(name)), wanted, "{name}");
        assert_eq!(number(&mut document, &format!("len({name})")), 3.0, "{name}");
    }
    check(text, &[("s", 1.0), ("t", 0.0), ("sum(r.y)", 21.0)]);
}

/// `a += b` is `a = a + b`: what is there is read first.
#[test]
fn what_is_there_is_read_before_what_is_added() {
    let text = "float x = 1, y = 1; vector v = {1, 0, 0}; farray a = {1, 2, 3, 4}; curve c[2];
                function float f(float t) { x += t; y += t; v.x += t; a[1] += t; c[1].x += t; return t; }
                for (k = 1:2) { x += f(1); v.x += f(1); a[1] += f(1); c[1] += {f(1), 0, 0}; }
                y += f(1); a += f(1);";
    let mut twin = [1.0_f64, 1.0, 1.0, 1.0, 0.0];
    let f = |all: &mut [f64; 5]| all.iter_mut().for_each(|x| *x += 1.0);
    for _ in 0..2 {
        for k in [0, 2, 3, 4] {
            let old = twin[k];
            f(&mut twin);
            twin[k] = old + 1.0;
        }
    }
    let y = twin[1];
    f(&mut twin);
    twin[1] = y + 1.0;
    let a = twin[3];
    f(&mut twin);
    twin[3] = a + 1.0;
    let [x, y, v, a, c] = twin;
    check(text, &[("x", x), ("y", y), ("v.x", v), ("a[1]", a), ("c[1].x", c)]);
}

#[test]
fn numbers_beside_masks_give_masks() {
    let arrays = "farray a = {1,2,3,4,5}; int one = 1, none = 0; a[one or a > 3] = 0; farray b = {1,2,3,4,5};
                  b[none and b > 3] = 9; farray c = (none or b > 3), d = (one and b > 3), e = (b > 3 or one);
                  curve k[6]; k.x = uniform(0, 5, 6); k[one or k.x > 4].y = 3;";
    check(
        arrays,
        &[
            ("sum(a)", 0.0),
            ("sum(b)", 15.0),
            ("sum(c)", 2.0),
            ("sum(d)", 2.0),
            ("sum(e)", 5.0),
            ("sum(k.y)", 18.0),
            ("any(none and b > 3)", 0.0),
            ("all(one or b > 3)", 1.0),
            ("len(reverse(one or b > 3))", 5.0),
        ],
    );
    // The right operand of numbers is evaluated only if needed; that of a mask always.
    check(
        "int n = 0; farray a[3] = 1; int k = n > 0 and a[n] > 0; int l = n == 0 or a[n] > 0;",
        &[("k", 0.0), ("l", 1.0)],
    );
    check(
        "function float f(float x) { assert 0; return x; } int k = 0 and f(1); int l = 1 or f(1);",
        &[("k", 0.0), ("l", 1.0)],
    );
    refused("farray a = {1, 2, 3, 4}; int one = 1; if (one or a > 3) print 1;", "wrong-condition");
}

#[test]
fn lists_stay_lists() {
    let text = format!(
        "{GRID}surface parts[3]; for (k=1:3) parts[k] = g + {{0, 0, k}};
         parts[2][1,1].z = 9; surface more[] = {{g, g[1:2,], g}}; more = append(more, g);
         block layers = stack(g, g + {{0, 0, 1}}), blocks[2]; blocks[1] = layers; blocks[2] = layers + {{5, 0, 0}};
         function float heights(surface s[]) {{ float z = 0; foreach (p in s) z += p[2,2].z; return z; }}
         subroutine lift(returned surface s, float dz) {{ s.z += dz; }}
         subroutine lift_all(returned surface s[], float dz) {{ for (k=1:len(s)) s[k].z += dz; }}
         float before = heights(parts); lift(parts[3], 10); float after = heights(parts); lift_all(parts, 1);
         function float total(surface s...) {{ return heights(s); }} float several = total(g, g + {{0, 0, 2}});
         curve lines[2][4]; lines[2][4].x = 7; curve copy[] = lines;"
    );
    check(
        &text,
        &[
            ("len(parts)", 3.0),
            ("parts[2][1,1].z", 10.0),
            ("parts[3][3,3].z", 14.0),
            ("before", 6.0),
            ("after", 16.0),
            ("several", 2.0),
            ("len(more)", 4.0),
            ("more[2].d1", 2.0),
            ("blocks[2][1,1,2].x", 6.0),
            ("blocks[1].d3", 2.0),
            ("layers[2][1,1].z", 1.0),
            ("copy[2][4].x", 7.0),
            ("lines[1].d1", 4.0),
        ],
    );
    refused("surface parts[2]; print parts[1];", "no-value");
    refused("surface parts[2]; parts[3] = parts[1];", "no-value");
    refused(&format!("{GRID}surface parts[2]; parts[3] = g;"), "outside");
    refused(&format!("{GRID}surface parts[2]; parts[1] = g[1,];"), "wrong-type");
    refused(&format!("{GRID}surface parts[2] = {{g}};"), "shapes-differ");
    refused(&format!("{GRID}block b = {{g, g[1:2,]}};"), "wrong-type");
    refused("float q[] = {1, 2};", "wrong-type");
}

#[test]
fn records_have_members() {
    let text = format!(
        "{GRID}record section {{ float chord = 1, twist; curve points[5]; }}
         record wing {{ float span = 4; surface skin; section ribs[2]; string name = \"wing\"; }}
         wing a; wing b = wing(6, skin = g, name = \"tail\"); b.ribs[2].chord = 3; b.ribs[1].points[2].y = 8;
         wing c = b; c.span = 9; wing fleet[2]; fleet[1] = b; fleet[2].ribs[1].twist = .5;
         function float area(wing w) {{ return w.span*w.ribs[2].chord; }}
         function wing longer(wing w, float by = 2) {{ w.span *= by; return w; }}
         subroutine twist(returned wing w, float by) {{ w.ribs[1].twist += by; }} twist(b, .25);
         wing d = longer(b), e = longer(b, 3);"
    );
    check(
        &text,
        &[
            ("a.span", 4.0),
            ("a.ribs[2].chord", 1.0),
            ("area(b)", 18.0),
            ("b.ribs[1].points[2].y", 8.0),
            ("b.ribs[1].twist", 0.25),
            ("c.ribs[1].twist", 0.0),
            ("c.span - b.span", 3.0),
            ("fleet[1].skin[3,3].x", 3.0),
            ("fleet[2].ribs[1].twist", 0.5),
            ("len(fleet)", 2.0),
            ("d.span", 12.0),
            ("e.span", 18.0),
            ("b.name == \"tail\"", 1.0),
        ],
    );
    let wing = "record wing { float span = 4; } record tail { float span; }\n";
    refused(&format!("{wing}wing w; w.spam = 1;"), "unknown-member");
    refused(&format!("{wing}wing w; print w.spam;"), "unknown-member");
    refused(&format!("{wing}wing w = wing(sweep = 1);"), "unknown-argument");
    refused(&format!("{wing}wing w = tail(1);"), "wrong-type");
    refused(&format!("{wing}wing w; w = tail(1);"), "wrong-type");
    refused(&format!("{wing}wing w; w.span = \"long\";"), "wrong-type");
    refused(&format!("{wing}subroutine f(wing w) {{}} f(tail(1));"), "wrong-type");
    refused("record a { print 1; }", "misplaced-statement");
    refused("record a { a inner; } a x;", "nested-too-deep");
}

#[test]
fn arguments_have_values_of_their_own() {
    check(
        "float unit = 10; function float f(float a, float b = 2*a, float c = unit) { return 100*a + 10*b + c; }
         float x = f(1), y = f(1, 3), z = f(1, c = 0); float sum; for (i=1:3) sum += f(i);",
        &[("x", 130.0), ("y", 140.0), ("z", 120.0), ("sum", 750.0)],
    );
    refused("function float f(float a = 1, float b) { return a; }", "misplaced-default");
    refused("subroutine f(returned curve c = 1) {}", "misplaced-default");
    refused("function float f(float x) { float x = 3; return x; }", "duplicate-name");
    refused("subroutine f(float x) { if (x > 0) { curve x[3]; } }", "duplicate-name");
}

#[test]
fn texts_are_cut_found_and_read() {
    check(
        "string t = \"naca 2412.dat\", words[] = split(t); float n = number(cut(words[2], 1, 4)); int at = find(t, \".\");
         string all[] = split(\"1;2;3\", \";\"); float s = 0; foreach (w in all) s += number(w);",
        &[
            ("n", 2412.0),
            ("at", 10.0),
            ("find(t, \"x\")", 0.0),
            ("len(words)", 2.0),
            ("cut(t, 11) == \"dat\"", 1.0),
            ("cut(t, 1, 0) == \"\"", 1.0),
            ("upper(lower(\"Ä\")) == \"Ä\"", 1.0),
            ("trim(replace(\" a-b \", \"-\", \"+\")) == \"a+b\"", 1.0),
            ("s", 6.0),
        ],
    );
    refused("float x = number(\"inf\");", "not-a-number");
    refused("string t = cut(\"abc\", 2, 9);", "outside");
}

#[test]
fn small_numbers_are_exact() {
    for k in 1..=22 {
        check(
            &format!("int a = 10^-{k} == 1e-{k}; int b = 10;"),
            &[("a", 1.0), (&format!("b^-{k} == 1e-{k}"), 1.0)],
        );
    }
    check(
        "farray a = {1, 2, 3, 4}; float k = -3; farray p = 10^{-1, -2, -3, -4};",
        &[
            ("sum(a[a > 9])", 0.0),
            ("prod(a[a > 9])", 1.0),
            ("10^k == 1e-3", 1.0),
            ("p[3] == 1e-3", 1.0),
            ("abs(hypot(3e200, 4e200)/5e200 - 1) < 3e-16", 1.0),
            ("abs(hypot(3e-200, 4e-200)/5e-200 - 1) < 3e-16", 1.0),
            ("hypot(3, 4)", 5.0),
        ],
    );
}
