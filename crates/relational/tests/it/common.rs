//! A minimal reader of declarations, so that kinds can be tried without the language and the graph:
//! `Kind name(arguments);` and `type name = function(arguments);` with literals and names only.

use moldloft_num::Vec3;
use moldloft_num::trace::Key;
use moldloft_registry::{
    CallError, Class, Context, CurveRef, Given, Point, Registry, Row, Scalar, SurfaceRef, Value,
    bind_arguments,
};
use std::sync::Arc;

/// One declared object.
pub struct Object<T: Scalar> {
    pub name: String,
    pub row: Arc<Row>,
    pub value: Value<T>,
}

/// The objects of a text, in order.
pub struct Scene<T: Scalar>(pub Vec<Object<T>>);

/// The scene of a text.
pub fn scene(text: &str) -> Scene<f64> {
    attempt(text).unwrap_or_else(|fault| panic!("{text}\n{fault:?}"))
}

/// The scene of a text, or its first fault.
pub fn attempt(text: &str) -> Result<Scene<f64>, CallError> {
    run(text, &mut |_, x| x)
}

/// The fault that a text ends with.
pub fn fault(text: &str) -> CallError {
    match attempt(text) {
        Ok(_) => panic!("no fault in {text}"),
        Err(fault) => fault,
    }
}

/// The scene of a text in which literal k of value x is replaced by `number(k, x)`.
pub fn run<T: Scalar>(
    text: &str,
    number: &mut dyn FnMut(usize, f64) -> T,
) -> Result<Scene<T>, CallError> {
    let registry =
        Registry::new(moldloft_relational::rows().into_iter().chain(moldloft_arrays::rows()));
    let tokens = tokens(text);
    let mut reader = Reader { tokens: &tokens, at: 0, literals: 0, number, scene: Scene(vec![]) };
    while reader.at < tokens.len() {
        let first = reader.word();
        let name = reader.word();
        let row = if reader.accept("=") { reader.word() } else { first };
        let row = registry.get(row).unwrap_or_else(|| panic!("no row {row}")).clone();
        reader.expect("(");
        let given = reader.arguments();
        reader.expect(";");
        let (args, _) = bind_arguments(&row, given, |_| Class::Any)?;
        let value = T::call(&row, &args, &Context::default())?;
        if !value.is_finite() {
            return Err(CallError::new("not-finite", format!("{name} is not finite")));
        }
        assert!(row.class.accepts(value.class()), "{} made {:?}", row.name, value.class());
        let value = value.named(Key(reader.scene.0.len() as u32));
        reader.scene.0.push(Object { name: name.to_string(), row, value });
    }
    Ok(reader.scene)
}

impl<T: Scalar> Scene<T> {
    pub fn value(&self, name: &str) -> &Value<T> {
        let object = self.0.iter().find(|o| o.name == name);
        &object.unwrap_or_else(|| panic!("no object {name}")).value
    }
    pub fn key(&self, name: &str) -> Key {
        Key(self.0.iter().position(|o| o.name == name).expect("an object") as u32)
    }
    pub fn surface(&self, name: &str) -> &SurfaceRef<T> {
        let Value::Surface(s) = self.value(name) else { panic!("{name} is no surface") };
        s
    }
    pub fn curve(&self, name: &str) -> &CurveRef<T> {
        let Value::Curve(c) = self.value(name) else { panic!("{name} is no curve") };
        c
    }
    pub fn point(&self, name: &str) -> &Point<T> {
        let Value::Point(p) = self.value(name) else { panic!("{name} is no point") };
        p
    }
}

fn tokens(text: &str) -> Vec<&str> {
    let mut all = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let plain = |c: char| c.is_alphanumeric() || "_.-+".contains(c);
        let end = match first {
            '"' => rest[1..].find('"').expect("a closing quote") + 2,
            c if plain(c) => rest.find(|c| !plain(c)).unwrap_or(rest.len()),
            c => c.len_utf8(),
        };
        all.push(&rest[..end]);
        rest = rest[end..].trim_start();
    }
    all
}

struct Reader<'a, T: Scalar> {
    tokens: &'a [&'a str],
    at: usize,
    literals: usize,
    number: &'a mut dyn FnMut(usize, f64) -> T,
    scene: Scene<T>,
}

impl<'a, T: Scalar> Reader<'a, T> {
    fn word(&mut self) -> &'a str {
        self.at += 1;
        self.tokens[self.at - 1]
    }

    fn accept(&mut self, token: &str) -> bool {
        let found = self.tokens.get(self.at) == Some(&token);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, token: &str) {
        assert!(self.accept(token), "expected {token} at {:?}", &self.tokens[self.at..]);
    }

    fn arguments(&mut self) -> Given<'a, T> {
        let mut given = Given { positional: vec![], named: vec![] };
        while !self.accept(")") {
            if self.tokens[self.at + 1] == "=" {
                let name = self.word();
                self.expect("=");
                let value = self.value();
                given.named.push((name, value));
            } else {
                let value = self.value();
                given.positional.push(value);
            }
            self.accept(",");
        }
        given
    }

    fn value(&mut self) -> Value<T> {
        let token = self.word();
        if token == "{" {
            let mut items = Vec::new();
            while !self.accept("}") {
                items.push(self.value());
                self.accept(",");
            }
            if let [Value::Number(x), Value::Number(y), Value::Number(z)] = items[..] {
                return Value::Vector(Vec3::new(x, y, z));
            }
            return Value::list(items);
        }
        if let Some(text) = token.strip_prefix('"') {
            return Value::text(text.trim_end_matches('"'));
        }
        if let Ok(x) = token.parse() {
            self.literals += 1;
            return Value::Number((self.number)(self.literals - 1, x));
        }
        self.scene.value(token).clone()
    }
}

/// Table 2 of Letcher and Shook (1995): the hull of a sailing yacht.
pub const HULL: &str = "
AbsPoint P11(0, 0, 3.6); AbsPoint P12(1.367, 0, 0.602); AbsPoint P13(2.324, 0, -0.8);
AbsPoint P14(3, 0, -0.9); BCurve MC1({P11, P12, P13, P14}, degree = 2);
AbsPoint P21(15, 4.815, 2.56); AbsPoint P22(15, 5.046, 0.628); AbsPoint P23(15, 3.603, -0.87);
AbsPoint P24(15, 0, -1.175); BCurve MC2({P21, P22, P23, P24}, degree = 2);
AbsPoint P31(30, 3.5, 2.76); AbsPoint P32(30, 3.5, 1.32); AbsPoint P33(30, 2.5, 0.12);
AbsPoint P34(30, 0, 0.12); BCurve MC3({P31, P32, P33, P34}, degree = 2);
CLoftSurf hull({MC1, MC2, MC3}, divisions = {10, 20});";
