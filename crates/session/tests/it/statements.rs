//! Statements that hands write, delete and duplicate: where they come in the text.

use crate::viewer::{ask, edited, session};
use moldloft_session::Session;
use serde_json::{Value, json};

const TEXT: &str = "# A plate\nparam float w = 2 in [1, 3];\n\
    AbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0);   # the lower edge\nLine l(A, B);\n\
    float h = 3;\nAbsPoint C(0, 0, h);\n# the end\n";

fn made(s: &mut Session, text: &str, request: Value) -> String {
    let reply = ask(s, request.clone());
    assert!(reply.head.get("error").is_none(), "{request}: {}", reply.head);
    let new = edited(text, &reply);
    ask(s, json!({"kind": "text", "text": text}));
    // The text itself is in order.
    let open = ask(&mut session(&new), json!({"kind": "open"}));
    let errors = open.head["diagnostics"].as_array().unwrap().iter();
    assert_eq!(errors.filter(|d| d["severity"] == "error").count(), 0, "{new}\n{}", open.head);
    new
}

fn refused(s: &mut Session, request: Value) -> String {
    let reply = ask(s, request.clone());
    ask(s, json!({"kind": "text", "text": TEXT}));
    reply.head["error"].as_str().unwrap_or_else(|| panic!("{request}: {}", reply.head)).into()
}

#[test]
fn a_statement_comes_behind_those_of_its_kind_and_what_it_reads() {
    let mut s = session(TEXT);
    let add = |statement: &str| json!({"kind": "add", "statement": statement});
    let new = made(&mut s, TEXT, add("AbsPoint D(w, 0, h);"));
    assert_eq!(new, TEXT.replace("C(0, 0, h);\n", "C(0, 0, h);\nAbsPoint D(w, 0, h);\n"));
    let new = made(&mut s, TEXT, add("Line m(A, B);"));
    assert_eq!(new, TEXT.replace("Line l(A, B);\n", "Line l(A, B);\nLine m(A, B);\n"));
    let new = made(&mut s, TEXT, add("BCurve c({A, B, C}, degree = 2);"));
    assert_eq!(new, TEXT.replace("h);\n", "h);\nBCurve c({A, B, C}, degree = 2);\n"));
    let new = made(&mut s, TEXT, add("param float d = 1 in [0, 2];"));
    assert!(new.contains("in [1, 3];\nparam float d = 1 in [0, 2];\nAbsPoint A"), "{new}");
    // The first of all.
    for (text, statement) in [
        ("", "AbsPoint P(1, 2, 3);"),
        ("Model info(units = \"m\");", "param float w = 2 in [1, 3];"),
        ("AbsPoint P(1, 2, 3);", "param float w = 2 in [1, 3];"),
        ("for (k = 0:3) { AbsPoint q(k, 0, 0); }\nAbsPoint r(0, 0, 0);", "Line l(q[0], q[3]);"),
    ] {
        let new = made(&mut session(text), text, add(statement));
        assert!(new.contains(statement), "{new}");
    }
    for (statement, part) in [
        ("AbsPoint A(1, 2, 3);", "used already"),
        ("AbsPoint D(1, 2, 3); AbsPoint E(1, 2, 3);", "one object"),
        ("AbsPoint D(1, 2", "not closed"),
        ("Line m(A, nobody);", "nobody"),
        ("Line m(A, l);", "found a curve"),
    ] {
        let said = refused(&mut s, add(statement));
        assert!(said.contains(part), "{statement}: {said}");
    }
    assert_eq!(s.text(), TEXT);
}

#[test]
fn objects_are_deleted_duplicated_and_renamed() {
    let mut s = session(TEXT);
    let new = made(&mut s, TEXT, json!({"kind": "delete", "name": "C"}));
    assert_eq!(new, TEXT.replace("AbsPoint C(0, 0, h);\n", ""));
    let said = refused(&mut s, json!({"kind": "delete", "name": "A"}));
    assert!(said.contains("cannot be deleted"), "{said}");
    let reply = ask(&mut s, json!({"kind": "duplicate", "name": "B"}));
    assert_eq!(reply.head["name"], "B1");
    assert!(
        edited(TEXT, &reply)
            .contains("AbsPoint B(w, 0, 0);   # the lower edge\nAbsPoint B1(w, 0, 0);")
    );
    ask(&mut s, json!({"kind": "text", "text": TEXT}));
    let new = made(&mut s, TEXT, json!({"kind": "rename_object", "name": "A", "new": "bow"}));
    assert!(new.contains("AbsPoint bow(0") && new.contains("l(bow, B)"), "{new}");
}

#[test]
fn a_statement_is_moved_beside_another_with_its_comment() {
    let text = "# A plate\nAbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0);   # the lower edge\n\
        AbsPoint C(0, 0, 3); # above\nLine l(A, B);\nLine m(A,\n  C);\nAbsPoint D(1, 1, 1);";
    let mut s = session(text);
    let mut moved = |name: &str, beside: &str, behind: bool| {
        let request = json!({"kind": "reorder", "name": name, "beside": beside, "behind": behind});
        let new = made(&mut s, text, request);
        // As many statements as before, and the same words.
        let words = |t: &str| {
            let mut all: Vec<_> = t.split_whitespace().map(str::to_string).collect();
            all.sort();
            all
        };
        assert_eq!(words(&new), words(text), "{new}");
        new
    };
    // Whole lines, also of two.
    let new = moved("m", "l", false);
    assert!(
        new.contains("# above\nLine m(A,\n  C);\nLine l(A, B);\nAbsPoint D(1, 1, 1);"),
        "{new}"
    );
    let new = moved("l", "m", true);
    assert!(
        new.contains("# above\nLine m(A,\n  C);\nLine l(A, B);\nAbsPoint D(1, 1, 1);"),
        "{new}"
    );
    let new = moved("D", "C", false);
    assert!(
        new.contains("edge\nAbsPoint D(1, 1, 1);\nAbsPoint C(0, 0, 3); # above\nLine l"),
        "{new}"
    );
    // Of several in a line.
    let new = moved("A", "B", true);
    assert!(
        new.contains("plate\nAbsPoint B(2, 0, 0);   # the lower edge\nAbsPoint A(0, 0, 0);\n"),
        "{new}"
    );
    let new = moved("B", "A", false);
    assert!(
        new.contains("AbsPoint B(2, 0, 0);\nAbsPoint A(0, 0, 0);   # the lower edge\n"),
        "{new}"
    );
    // A comment does not swallow what follows.
    let new = moved("C", "A", true);
    assert!(new.contains("A(0, 0, 0);\nAbsPoint C(0, 0, 3); # above\n AbsPoint B"), "{new}");
    assert_eq!(moved("D", "m", true), text);
    assert_eq!(moved("A", "A", true), text);
}

#[test]
fn a_statement_is_not_moved_where_the_program_would_fail() {
    let mut s = session(TEXT);
    let to = |name: &str, beside: &str| json!({"kind": "reorder", "name": name, "beside": beside, "behind": false});
    assert!(refused(&mut s, to("l", "A")).contains("cannot be moved there"));
    assert!(refused(&mut s, to("C", "A")).contains("cannot be moved there"));
    assert!(refused(&mut s, to("nobody", "A")).contains("nobody"));
    assert_eq!(s.text(), TEXT);
    let text = "AbsPoint P(0, 0, 0);\nfor (k = 0:3) { AbsPoint q(k, 0, 0); }\n";
    let reply = ask(&mut session(text), to("P", "q[1]"));
    assert!(reply.head["error"].as_str().is_some_and(|e| !e.is_empty()), "{}", reply.head);
}

#[test]
fn each_kind_has_a_row_for_a_form() {
    let reply = ask(&mut session(""), json!({"kind": "kinds"}));
    let kinds = reply.head["kinds"].as_array().unwrap();
    let line = kinds.iter().find(|k| k["name"] == "Line").unwrap();
    let first = &line["fields"][0];
    assert_eq!((&first["required"], &first["many"]), (&json!(true), &json!(false)));
    assert!(first["accepts"].as_array().unwrap().contains(&json!("bead")));
    assert!(kinds.len() > 50 && kinds.iter().all(|k| k["about"] != ""));
}
