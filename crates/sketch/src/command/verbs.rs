//! The verbs, how they may be shortened, and their help.

use super::Fault;

/// Every verb with its use and what it does.
pub const VERBS: &[(&str, &str, &str)] = &[
    ("SKETCH", "SKETCH [name] [2D [XY|XZ|YZ] | 3D]", "starts an object, or goes on with it"),
    ("MODIFY", "MODIFY [name]", "goes on with an object"),
    ("POINT", "POINT [id] [AT] u v", "draws a point, or moves it on the page"),
    ("LINE", "LINE [id] [FROM] p [TO] q [TYPE X|Y|Z|H|P|F|O]", "draws a line; its slope names it"),
    ("POLYLINE", "POLYLINE p q … [CLOSE]", "draws lines from point to point"),
    ("SPLIT", "SPLIT line part", "puts a point on a line, at a part of its length"),
    ("WELD", "WELD p q", "makes two points one"),
    (
        "DELETE",
        "DELETE name | DELETE POINT|LINE|FACE|CURVE|DIMENSION id …",
        "removes an object or parts",
    ),
    (
        "AXES",
        "AXES α β [γ] | preset | AUTO [SCALE x y z]",
        "says how the axes were drawn, in degrees",
    ),
    ("TYPE", "TYPE line … [AS] type | TYPE AUTO", "types lines"),
    ("ALIGN", "ALIGN axis p q …", "puts points into one plane"),
    ("UNALIGN", "UNALIGN axis p q", "takes that back"),
    (
        "DIMENSION",
        "DIMENSION [name] [axis] p [TO] q [value] [REVERSED|FORWARD] [IN lo hi] | LENGTH l | SLOPE l | ANGLE l m | EQUAL l m",
        "gives a dimension",
    ),
    (
        "SET",
        "SET name value | POINT p axis value | UP axis | NAMES SEED|STANDARD | UNITS u | SKETCH83 ON|OFF",
        "changes a dimension, variable or setting",
    ),
    ("UNSET", "UNSET name", "takes a value away"),
    ("VARIABLE", "VARIABLE name value [IN lo hi]", "defines a named number"),
    ("REFERENCE", "REFERENCE p x y [z]", "says where a point is"),
    ("REVERSE", "REVERSE name", "turns the direction of a dimension"),
    ("EXTENSIONS", "EXTENSIONS [axis]", "lists the dimensioning planes"),
    ("CHECK", "CHECK [name]", "lists what is doubtful, missing or contradictory"),
    ("WHY", "WHY name | WHY axis p q | WHY p", "explains a plane or a dimension"),
    ("ESTIMATE", "ESTIMATE", "guesses the solid from the picture"),
    ("CONVERT", "CONVERT [name]", "computes the coordinates"),
    ("GENERATE", "GENERATE FACES [name] [ASK|AUTO]", "finds the faces"),
    ("CREATE", "CREATE FACES [name] [ASK|AUTO]", "the same"),
    ("FACE", "FACE [id RUNS] p q r … {HOLE p q r …}", "adds a face"),
    ("CHOOSE", "CHOOSE n", "takes the n-th solid that fits"),
    ("EXTRUDE", "EXTRUDE [name] [axis] value", "makes a solid of a cross section"),
    ("REVOLVE", "REVOLVE [name] line angle", "turns a cross section about one of its lines"),
    ("CLEAN", "CLEAN [name]", "removes lines between faces of one plane"),
    ("MERGE", "MERGE a [b] [INTO] c [TOL t]", "unites objects"),
    ("MEASURE", "MEASURE [name] [VOLUME|AREA|CENTROID|INERTIA]", "prints properties"),
    (
        "ARC",
        "ARC [name] LINES l m | CORNER p [a b] [RADIUS value] [STEPS n] [KEEP]",
        "rounds a corner",
    ),
    (
        "CIRCLE",
        "CIRCLE [name] LINES l m | CORNER p [a b] [RADIUS value] [KEEP]",
        "a circle in a corner",
    ),
    ("QUADRATIC", "QUADRATIC [name] LINES l m | POINTS a b c", "a parabola through three points"),
    ("PARABOLA", "PARABOLA [name] LINES l m | POINTS a b c", "the same"),
    ("CUBIC", "CUBIC [name] LINES l m n … | POINTS a b c d … [CENTRIPETAL]", "Overhauser cubics"),
    ("OVERHAUSER", "OVERHAUSER [name] LINES l m n … | POINTS a b c d …", "the same"),
    (
        "ELLIPSE",
        "ELLIPSE [name] [ARC|FULL] LINES l m | CORNER p [a b] [SEMI m n] [KEEP]",
        "an ellipse or its quarter",
    ),
    ("USING", "USING name", "makes an object the active one"),
    ("RENAME", "RENAME old [TO] new", "renames an object"),
    ("COPY", "COPY name [TO] name", "copies an object"),
    ("MOVE", "MOVE name dx dy dz", "moves an object"),
    ("ROTATE", "ROTATE name axis degrees", "turns an object by quarter turns"),
    ("MIRROR", "MIRROR name axis", "mirrors an object"),
    ("SCALE", "SCALE name factor", "scales an object"),
    ("DUMP", "DUMP [name]", "prints an object as JSON"),
    (
        "SAVE",
        "SAVE [name …] [AS] [file]",
        "writes objects as commands, or as JSON by the file's name",
    ),
    ("INPUT", "INPUT file [INTO name]", "reads objects"),
    ("RUN", "RUN file", "runs a file of commands"),
    ("EXPORT", "EXPORT STL|OBJ|GLTF|3MF|DXF|SVG|JSON|SKETCH83 [name] [file]", "writes an object"),
    ("DISPLAY", "DISPLAY [name|ALL]", "shows objects"),
    ("ERASE", "ERASE [name|ALL]", "hides objects"),
    (
        "SHOW",
        "SHOW LABELS|PLANES|TYPES [ON|OFF] | FACE id",
        "what the picture shows; traces a face",
    ),
    ("ZOOM", "ZOOM [factor | FIT | WINDOW u v u v]", "the part of the page that the picture shows"),
    ("PAN", "PAN du dv", "moves that part"),
    ("VIEW", "VIEW preset|TOP|FRONT|SIDE|SKETCH", "from where the picture shows solids"),
    (
        "LIST",
        "LIST [POINTS|LINES|FACES|CURVES|DIMENSIONS|PLANES|OBJECTS|VARIABLES] [name]",
        "lists parts",
    ),
    ("UNDO", "UNDO [n]", "takes back commands"),
    ("REDO", "REDO [n]", "does them again"),
    ("HISTORY", "HISTORY", "lists the commands so far"),
    ("HELP", "HELP [verb]", "explains a verb"),
    ("QUIT", "QUIT", "ends"),
    ("END", "END", "ends the definition of an object"),
    (
        "GIVE",
        "GIVE name X p TO q|POINT p X|LENGTH l|… = value [ONLY]",
        "a dimension exactly as it is, for files",
    ),
    ("DECLARE", "DECLARE name value [IN lo hi]", "a variable that may read later names, for files"),
    ("ACCEPT", "ACCEPT", "answers a question about a face"),
    ("REJECT", "REJECT", "answers a question about a face"),
    ("REPEAT", "REPEAT", "asks again"),
    ("YES", "YES", "answers a question"),
    ("NO", "NO", "answers a question"),
];

/// The verb that a word stands for, and a note when it was read generously.
///
/// Exact, or a unique beginning, or the first three letters (manual, appendix D: interpreters look at
/// the first two or three characters only, so that later misspelling does no harm).
///
/// # Errors
/// Names the verbs it could be.
pub fn find(word: &str) -> Result<(&'static str, Option<String>), Fault> {
    let upper = word.to_ascii_uppercase();
    let names = || VERBS.iter().map(|v| v.0);
    if let Some(verb) = names().find(|v| *v == upper) {
        return Ok((verb, None));
    }
    let starting: Vec<&str> = names().filter(|v| v.starts_with(upper.as_str())).collect();
    match starting[..] {
        [verb] => return Ok((verb, None)),
        [] => {}
        // QUADRATIC, PARABOLA and their likes are one command under several names.
        _ => {
            let all = starting.join(" or ");
            return Err(Fault::text(format!("{all}?"), "type one more letter"));
        }
    }
    let head: String = upper.chars().take(3).collect();
    if head.chars().count() == 3 {
        let like: Vec<&str> = names().filter(|v| v.starts_with(head.as_str())).collect();
        match like[..] {
            [verb] => return Ok((verb, Some(format!("read {upper} as {verb}")))),
            [] => {}
            _ => {
                // Several begin alike (EXTRUDE, EXTENSIONS): the nearest spelling decides.
                if let Some(verb) = moldloft_diag::nearest(&upper, like.iter().copied()) {
                    let verb = like.iter().find(|v| **v == verb).copied().unwrap_or(like[0]);
                    return Ok((verb, Some(format!("read {upper} as {verb}"))));
                }
                let all = like.join(" or ");
                return Err(Fault::text(format!("{all}?"), "type one more letter"));
            }
        }
    }
    let next = match moldloft_diag::nearest(&upper, names()) {
        Some(near) => format!("did you mean {near}?"),
        None => "HELP lists all commands".to_owned(),
    };
    Err(Fault::text(format!("there is no command {upper}"), next))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!(
            fault.text.contains("DIMENSION") && fault.text.contains("DISPLAY"),
            "{}",
            fault.text
        );
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
}
