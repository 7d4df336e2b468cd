//! Abbreviations and synonyms of verbs.

use moldloft_sketch::command::verbs::find;

#[test]
fn words_stand_for_verbs() {
    for (word, verb) in [
        ("DIM", "DIMENSION"),
        ("DIME", "DIMENSION"),
        ("dimenson", "DIMENSION"),
        ("us", "USING"),
        ("gen", "GENERATE"),
        ("MERGE", "MERGE"),
        ("QUADRATC", "QUADRATIC"),
        ("extr", "EXTRUDE"),
        ("exte", "EXTENSIONS"),
    ] {
        assert_eq!(find(word).unwrap().0, verb, "{word}");
    }
    assert!(find("DIMENSON").unwrap().1.unwrap().contains("DIMENSION"));
    let fault = find("DI").unwrap_err();
    assert!(fault.text.contains("DIMENSION") && fault.text.contains("DISPLAY"), "{}", fault.text);
    assert!(find("XYZZY").is_err() && find("").is_err());
    assert!(find("RSKETCH").unwrap_err().next.contains("SKETCH"));
    // No two verbs of 1983 share three letters.
    let seed = [
        "SKETCH",
        "MODIFY",
        "AXES",
        "DIMENSION",
        "CONVERT",
        "GENERATE",
        "CREATE",
        "USING",
        "SAVE",
        "INPUT",
        "MERGE",
        "LIST",
        "RENAME",
        "DELETE",
        "DISPLAY",
        "ERASE",
        "SHOW",
        "ZOOM",
        "ARC",
        "CIRCLE",
        "ELLIPSE",
        "DUMP",
    ];
    for verb in seed {
        let head = &verb[..3];
        assert_eq!(find(head).map(|v| v.0), Ok(verb), "{head}");
    }
}
