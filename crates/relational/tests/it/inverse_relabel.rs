//! Continuation of inverse reparametrisations beyond their ends.

use crate::common::scene;
use moldloft_num::{Order, inv_reparametrization};
use moldloft_registry::Value;

#[test]
fn continuations_are_straight() {
    let scene = scene("GeoRelabel law(4); InvRelabel inverse(law);");
    let [law, inverse] = [0, 1].map(|k| match &scene.0[k].value {
        Value::Relabel(relabel) => relabel,
        _ => panic!("a relabel"),
    });
    let slope = 1.0 / law.jet(1.0, Order::First)[1];
    let jet = inverse.jet(1.5, Order::Second);
    assert!((jet[0] - (1.0 + 0.5 * slope)).abs() < 1e-15 && jet[2] == 0.0);
    assert!((inv_reparametrization(&**inverse, 0.3) - law.jet(0.3, Order::Zero)[0]).abs() < 1e-14);
}
