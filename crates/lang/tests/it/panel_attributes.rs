//! Attributes of panels in model files.

use moldloft_lang::parts::panel_attributes::{read, written};
use moldloft_registry::{Attributes, Class, Value};

#[test]
fn what_is_written_is_read() {
    let mut head = Attributes::of(Class::Surface);
    let words = |words: &[&str]| Value::<f64>::list(words.iter().map(|w| Value::text(w)));
    head.set("size", &Value::list([Value::Number(0.5), Value::Number(0.0)])).unwrap();
    let spacing = [Value::<f64>::text("cosine"), Value::Number(1.25)];
    head.set("spacing", &Value::list(spacing)).unwrap();
    head.set("tags", &words(&["wetted", "keel"])).unwrap();
    let text = written(head.panels.as_ref().unwrap());
    assert_eq!(text, " A:Size(0.5 auto) A:Spacing(cosine 1.25) A:Tags(wetted keel)");
    let mut again = Attributes::of(Class::Surface);
    for part in text.trim().trim_end_matches(')').split(") ") {
        let (name, value) = part.trim_start_matches("A:").split_once('(').unwrap();
        assert!(read(&mut again, name, value));
    }
    assert_eq!(again.panels, head.panels);
}

#[test]
fn others_of_the_name_are_left_alone() {
    let mut head = Attributes::of(Class::Surface);
    for (name, text) in [("Size", "big"), ("Spacing", "1 2 3"), ("Size", "-1 2"), ("Note", "x")] {
        assert!(!read(&mut head, name, text), "{name}({text})");
    }
    assert_eq!(head, Attributes::of(Class::Surface));
}
