//! An exact derivative: how the volume and a point of a body move with its parameters, compared with
//! differences. `cargo run -p moldloft --example derivative`.

use moldloft::{Document, NoFiles, Value, registry};

const BODY: &str = "
    param float length = 4 in [2, 6]; param float radius = 1 in [0.5, 2];
    AbsPoint A(0, 0, 0); AbsPoint B(0.5 * length, 0, 2 * radius); AbsPoint C(length, 0, 0);
    BCurve profile({A, B, C}, degree = 2); Line axis(A, C);
    RevSurf body(profile, axis, divisions = {24, 48});
";

/// The value of an expression that is a number.
fn number(model: &mut Document, text: &str) -> Result<f64, String> {
    match model.eval(text) {
        Ok(Value::Number(x)) => Ok(x),
        Ok(_) => Err(format!("`{text}` is no number")),
        Err(faults) => Err(faults[0].message.to_string()),
    }
}

/// Prints exact derivatives beside differences; an error when they differ.
pub fn main() -> Result<(), String> {
    let mut model = Document::from_text(registry(), Box::new(NoFiles), "body.sdl", BODY);
    let (texts, parameters) = (["mesh.volume", "body(0.25, 0).z"], ["length", "radius"]);
    let own = |words: &[&str]| words.iter().map(|w| (*w).to_owned()).collect::<Vec<_>>();
    let exact = model
        .derivatives(&own(&texts), &own(&parameters))
        .map_err(|faults| faults[0].message.to_string())?;
    for (k, text) in texts.iter().enumerate() {
        let value = number(&mut model, text)?;
        println!("{text} = {value:.12}");
        for (l, parameter) in parameters.iter().enumerate() {
            let Value::Number(slope) = exact[k][l] else { return Err("not a number".into()) };
            let at = number(&mut model, parameter)?;
            let step = 1e-5;
            let mut side = |x: f64| {
                model.set(&[((*parameter).to_owned(), x)]).map_err(|f| f[0].message.to_string())?;
                number(&mut model, text)
            };
            let difference = (side(at + step)? - side(at - step)?) / (2.0 * step);
            side(at)?;
            println!("  d/d{parameter} = {slope:.12}, by differences {difference:.12}");
            if (slope - difference).abs() > 1e-7 * (1.0 + slope.abs()) {
                return Err(format!("d({text})/d{parameter} is {slope}, not {difference}"));
            }
        }
    }
    Ok(())
}
