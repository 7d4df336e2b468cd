//! Families of plane sections.

use moldloft_num::Real;
use moldloft_registry::{Build, Context, Contours, Fault, Kind, Value};
use std::sync::Arc;

/// The most sections of one family.
const MOST_SECTIONS: i64 = 10_000;

fn contours<T: Real>(
    axis: usize,
    [first, last]: [i32; 2],
    start: T,
    step: T,
) -> Result<Value<T>, Fault> {
    let count = i64::from(last) - i64::from(first) + 1;
    if count < 1 {
        return Err(Fault::new(
            "empty-range",
            format!("there is no section from {first} to {last}"),
        )
        .expected(format!("a last index of at least {first}"))
        .found(last.to_string())
        .in_field(1));
    }
    if count > MOST_SECTIONS {
        return Err(Fault::new("out-of-range", format!("{count} sections are too many"))
            .expected(format!("at most {MOST_SECTIONS}"))
            .found(count.to_string())
            .in_field(1));
    }
    let values = (first..=last).map(|i| start + step * f64::from(i)).collect();
    Ok(Value::Contours(Arc::new(Contours { axis, values })))
}

macro_rules! contour_kind {
    ($(#[$doc:meta])* $name:ident, $axis:literal, $example:literal) => {
        $(#[$doc])*
        #[derive(Kind)]
        #[kind(class = Contours, columns = "first last start step", example = $example)]
        pub struct $name<T: Real> {
            /// First index i.
            first: i32,
            /// Last index i.
            last: i32,
            /// Position of the section with index 0.
            start: T,
            /// Distance of neighbouring sections.
            step: T,
        }

        impl<T: Real> Build<T> for $name<T> {
            fn build(self, _: &Context) -> Result<Value<T>, Fault> {
                contours($axis, [self.first, self.last], self.start, self.step)
            }
        }
    };
}

contour_kind!(
    /// Sections x = start + i step, for i from first to last: the stations of a hull.
    XContours, 0, "XContours stations(0, 10, 1.8, 2.735);"
);
contour_kind!(
    /// Sections y = start + i step, for i from first to last: the buttocks of a hull.
    YContours, 1, "YContours buttocks(0, 4, 0.5, 0.5);"
);
contour_kind!(
    /// Sections z = start + i step, for i from first to last: the waterlines of a hull.
    ZContours, 2, "ZContours waterlines(-2, 2, 0, 0.25);"
);
