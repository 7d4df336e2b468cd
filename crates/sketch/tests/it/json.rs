//! The reader and writer of JSON.

use moldloft_sketch::json::Json;

#[test]
fn reads_what_it_writes() {
    let text = r#"{"a":[1,-2.5,1e-7,true,null],"b":{"c":"q\"\\\n\u0001é"},"d":[]}"#;
    let value = Json::parse(text).unwrap();
    assert_eq!(value.to_string(), text);
    assert_eq!(Json::parse(&value.to_string()), Ok(value.clone()));
    assert_eq!(value.get("a").unwrap().items()[1].number(), Some(-2.5));
    for bad in
        ["", "[1,", "{\"a\" 1}", "[1 2]", "\"x", "\"\\q\"", "1 2", "nul", "[\"\\u12\"]", "NaN"]
    {
        assert!(Json::parse(bad).is_err(), "{bad}");
    }
    assert!(Json::parse(&"[".repeat(100)).is_err());
}
