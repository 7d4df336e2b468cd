//! Weights.

use crate::laws::program::Program;

pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    Some(match kind {
        "Weight" => match p.random.below(4) {
            0 => format!("{}, mass = 3*w, margin = 5*h", p.point()),
            1 => format!("{{0.4*w, {}, -1}}, mass = 2", p.number(-1.0, 1.0)),
            2 => format!("{}, per = 0.3*h, group = \"rig\"", p.curve()),
            _ => format!("{}, per = 0.05*w, group = \"hull\"", p.surface()),
        },
        "WeightSum" => {
            let parts: Vec<String> = (0..3)
                .map(|_| {
                    let args = arguments(p, "Weight").expect("a recipe");
                    p.object("Weight", &args)
                })
                .collect();
            let inner = p.object("WeightSum", &format!("{{{}, {}}}", parts[0], parts[1]));
            format!("{{{inner}, {}}}", parts[2])
        }
        _ => return None,
    })
}
