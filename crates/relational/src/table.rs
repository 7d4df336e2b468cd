//! Points, curves and surfaces through the points of a file: imported data to build upon.
//!
//! No file is read here. The program that declares the object reads the table, and gives its points in the
//! argument `points`.

use crate::curve::CCurve;
use crate::surface::CLoftSurf;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, FromValue, Kind, Point, Value,
};
use std::sync::Arc;

/// A point of a table of points.
///
/// The file has a point in a line: x, y, z (or x, y) with blanks or commas between.
#[derive(Kind)]
#[kind(
    class = Point,
    columns = "file row",
    role = Table,
    example = "TabPoint top(row = 2, points = {{0, 0, 0}, {1, 2, 0.5}, {3, 2, 1}});"
)]
pub struct TabPoint<T: Real> {
    /// The file, relative to the program that declares the point.
    #[field(default = "")]
    file: Arc<str>,
    /// Number of the point, from 1.
    #[field(default = 1, min = 1)]
    row: usize,
    /// The points, if there is no file.
    #[field(default)]
    points: Option<Vec<Vec3<T>>>,
}

/// A curve through the points of a table: a CCurve or, with degree 1, a polyline.
///
/// The file has a point in a line: x, y, z (or x, y) with blanks or commas between.
#[derive(Kind)]
#[kind(
    class = Curve,
    columns = "relabel file degree",
    role = Table,
    example = "TabCurve c(points = {{0, 0, 0}, {1, 2, 0.5}, {3, 2, 1}, {4, 0, 1}}); \
               TabCurve lines(degree = 1, points = {{0, 0, 0}, {1, 2, 0.5}, {3, 2, 1}});"
)]
pub struct TabCurve<T: Real> {
    /// The file, relative to the program that declares the curve.
    #[field(default = "")]
    file: Arc<str>,
    /// 3 for a cubic spline, 1 for a polyline.
    #[field(default = 3, min = 1, max = 3)]
    degree: usize,
    /// The points, where there is no file.
    #[field(default)]
    points: Option<Vec<Vec3<T>>>,
}

/// A surface through the points of a table: a C-loft of the curves through its rows of points.
///
/// Consecutive rows with equal numbers of points; u runs along a row, v across the rows. Empty
/// lines between the rows, or the header of a Plot3D file with one grid, give their number.
#[derive(Kind)]
#[kind(
    class = Surface,
    columns = "file rows degree",
    role = Table,
    example = "TabSurf s(rows = 2, points = {{0, 0, 0}, {1, 2, 0.5}, {3, 2, 1}, {0, 0, 3}, {1, 1, 3}, {3, 2, 4}});"
)]
pub struct TabSurf<T: Real> {
    /// The file, relative to the program that declares the surface.
    #[field(default = "")]
    file: Arc<str>,
    /// Number of rows, two or more; 0 if the file determines it.
    #[field(default = 0)]
    rows: usize,
    /// 3 for cubic splines, 1 for polylines.
    #[field(default = 3, min = 1, max = 3)]
    degree: usize,
    /// The points, where there is no file.
    #[field(default)]
    points: Option<Vec<Vec3<T>>>,
}

/// The points of a table; a table without points is an error.
fn table<T: Real>(
    file: &str,
    points: Option<Vec<Vec3<T>>>,
    fields: [FieldId; 2],
) -> Result<Vec<Vec3<T>>, CallError> {
    match points {
        Some(points) => Ok(points),
        None if file.is_empty() => Err(CallError::new("no-table", "there is no table of points")
            .expected("a file, or points")
            .help("name the file: \"offsets.csv\", or give points = {{0, 0, 0}, ...}")
            .in_field(fields[0])),
        None => Err(CallError::new("no-table", format!("`{file}` was not read"))
            .expected("the points of the file")
            .in_field(fields[1])),
    }
}

fn free<T: Real>(xyz: Vec3<T>) -> Value<T> {
    Value::Point(Box::new(Point::free(xyz)))
}

impl<T: Real> Build<T> for TabPoint<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let points = table(&self.file, self.points, [Self::FILE, Self::POINTS])?;
        let count = points.len();
        match points.into_iter().nth(self.row - 1) {
            Some(point) => Ok(free(point)),
            None => {
                Err(CallError::new("out-of-range", format!("the table has no row {}", self.row))
                    .expected(format!("a row from 1 to {count}"))
                    .found(self.row.to_string())
                    .in_field(Self::ROW))
            }
        }
    }
}

/// The spline through points, by the kind that makes it.
fn spline<T: Real>(
    points: &[Vec3<T>],
    degree: usize,
    context: &Context,
    field: FieldId,
) -> Result<CurveRef<T>, CallError> {
    if points.len() < 2 {
        return Err(CallError::new("too-few-points", "a curve passes through two points at least")
            .expected("two points or more")
            .found(points.len().to_string())
            .in_field(field));
    }
    let curve = CCurve::through(points, degree).build(context);
    CurveRef::from_value(&curve.map_err(|fault| fault.in_field(field))?)
}

impl<T: Real> Build<T> for TabCurve<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let points = table(&self.file, self.points, [Self::FILE, Self::POINTS])?;
        spline(&points, self.degree, context, Self::POINTS).map(Value::Curve)
    }
}

impl<T: Real> Build<T> for TabSurf<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let points = table(&self.file, self.points, [Self::FILE, Self::POINTS])?;
        let (rows, count) = (self.rows, points.len());
        if rows < 2 || !count.is_multiple_of(rows) {
            return Err(CallError::new(
                "wrong-count",
                format!("{count} points are not {rows} rows"),
            )
            .expected("two rows or more, with as many points in each")
            .found(format!("{count} points, {rows} rows"))
            .help("say how many rows the table has: rows = 5")
            .in_field(Self::ROWS));
        }
        let curves: Result<Vec<_>, _> = points
            .chunks(count / rows)
            .map(|row| spline(row, self.degree, context, Self::POINTS))
            .collect();
        CLoftSurf::through(curves?, self.degree)
            .build(context)
            .map_err(|fault| fault.in_field(Self::POINTS))
    }
}
