//! The usual statements about shapes, for `impl` blocks of [`Curve`](crate::Curve),
//! [`Surface`](crate::Surface) and their formulas: facts ([`curve_facts!`](crate::curve_facts),
//! [`surface_facts!`](crate::surface_facts)), and batches that are evaluated point by point
//! ([`curve_one_by_one!`](crate::curve_one_by_one),
//! [`surface_one_by_one!`](crate::surface_one_by_one)).

/// Facts of a curve:
///
/// - `smooth`: one formula with continuous derivatives of all orders;
/// - `broken`: its breaks, stated beside this, are its joints and may be kinks (`joints_at_breaks`, `kinks_at_breaks`: one of
///   the two);
/// - `breaks of [self.curve]`: breaks, joints and kinks of that curve, at equal parameters;
/// - `open`: parameters do not wrap;
/// - `closed of [self.curve]`: they do where those of that curve do;
/// - `not_rational`: no rational form is known;
/// - `rational of [self.curve]`: of the same form as that curve.
#[macro_export]
macro_rules! curve_facts {
    ($($fact:ident $(of [$($base:tt)+])?),+ $(,)?) => {
        $($crate::curve_facts!(@ $fact $([$($base)+])?);)+
    };
    (@ smooth) => {
        fn breaks(&self) -> Vec<f64> {
            Vec::new()
        }
        fn joints(&self) -> Vec<f64> {
            Vec::new()
        }
        fn kinks(&self) -> Vec<f64> {
            Vec::new()
        }
    };
    (@ broken) => {
        $crate::curve_facts!(joints_at_breaks, kinks_at_breaks);
    };
    (@ joints_at_breaks) => {
        fn joints(&self) -> Vec<f64> {
            $crate::Curve::breaks(self)
        }
    };
    (@ kinks_at_breaks) => {
        fn kinks(&self) -> Vec<f64> {
            $crate::Curve::breaks(self)
        }
    };
    (@ breaks [$self:ident $($rest:tt)+]) => {
        fn breaks(&$self) -> Vec<f64> {
            $self $($rest)+.breaks()
        }
        fn joints(&$self) -> Vec<f64> {
            $self $($rest)+.joints()
        }
        fn kinks(&$self) -> Vec<f64> {
            $self $($rest)+.kinks()
        }
    };
    (@ open) => {
        fn closed(&self) -> bool {
            false
        }
    };
    (@ closed [$self:ident $($rest:tt)+]) => {
        fn closed(&$self) -> bool {
            $self $($rest)+.closed()
        }
    };
    (@ not_rational) => {
        fn rational(&self) -> $crate::Rational<1> {
            $crate::Rational::none()
        }
    };
    (@ rational [$self:ident $($rest:tt)+]) => {
        fn rational(&$self) -> $crate::Rational<1> {
            $self $($rest)+.rational()
        }
    };
}

/// Facts of a surface; see [`curve_facts!`](crate::curve_facts). Of a `broken` one a path crosses breaks where it meets their
/// lines u = const and v = const (`breaks_along_lines`); `breaks of [self.surface]` hands paths on.
#[macro_export]
macro_rules! surface_facts {
    ($($fact:ident $(of [$($base:tt)+])?),+ $(,)?) => {
        $($crate::surface_facts!(@ $fact $([$($base)+])?);)+
    };
    (@ smooth) => {
        fn breaks(&self) -> [Vec<f64>; 2] {
            [Vec::new(), Vec::new()]
        }
        fn joints(&self) -> [Vec<f64>; 2] {
            [Vec::new(), Vec::new()]
        }
        fn kinks(&self) -> [Vec<f64>; 2] {
            [Vec::new(), Vec::new()]
        }
        fn crossings(&self, _: &dyn Fn(f64) -> [f64; 2], _: &[f64]) -> Vec<f64> {
            Vec::new()
        }
    };
    (@ broken) => {
        $crate::surface_facts!(joints_at_breaks, kinks_at_breaks, breaks_along_lines);
    };
    (@ joints_at_breaks) => {
        fn joints(&self) -> [Vec<f64>; 2] {
            $crate::Surface::breaks(self)
        }
    };
    (@ kinks_at_breaks) => {
        fn kinks(&self) -> [Vec<f64>; 2] {
            $crate::Surface::breaks(self)
        }
    };
    (@ breaks_along_lines) => {
        fn crossings(&self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
            $crate::line_crossings(&$crate::Surface::breaks(self), path, spans)
        }
    };
    (@ breaks [$self:ident $($rest:tt)+]) => {
        fn breaks(&$self) -> [Vec<f64>; 2] {
            $self $($rest)+.breaks()
        }
        fn joints(&$self) -> [Vec<f64>; 2] {
            $self $($rest)+.joints()
        }
        fn kinks(&$self) -> [Vec<f64>; 2] {
            $self $($rest)+.kinks()
        }
        fn crossings(&$self, path: &dyn Fn(f64) -> [f64; 2], spans: &[f64]) -> Vec<f64> {
            $self $($rest)+.crossings(path, spans)
        }
        fn inner_planes(&$self) -> Vec<$crate::InnerPlane<'_>> {
            $self $($rest)+.inner_planes()
        }
    };
    (@ open) => {
        fn closed(&self) -> [bool; 2] {
            [false; 2]
        }
    };
    (@ closed [$self:ident $($rest:tt)+]) => {
        fn closed(&$self) -> [bool; 2] {
            $self $($rest)+.closed()
        }
    };
    (@ not_rational) => {
        fn rational(&self) -> $crate::Rational<2> {
            $crate::Rational::none()
        }
    };
    (@ rational [$self:ident $($rest:tt)+]) => {
        fn rational(&$self) -> $crate::Rational<2> {
            $self $($rest)+.rational()
        }
    };
}

/// Points of a curve, each by its jet.
#[macro_export]
macro_rules! curve_one_by_one {
    ($scalar:ty) => {
        fn grid(&self, ts: &[f64], out: &mut [$crate::Vec3<$scalar>]) {
            for (x, &t) in out.iter_mut().zip(ts) {
                *x = $crate::Curve::jet(self, <$scalar>::from(t), $crate::Order::Zero)[0];
            }
        }
    };
}

/// Points of a surface, each by its jet: on grids, along lines, scattered.
#[macro_export]
macro_rules! surface_one_by_one {
    ($scalar:ty: $($which:ident),+ $(,)?) => {
        $($crate::surface_one_by_one!(@ $which $scalar);)+
    };
    (@ grid $scalar:ty) => {
        fn grid(
            &self,
            us: &[f64],
            vs: &[f64],
            points: &mut [$crate::Vec3<$scalar>],
            mut normals: Option<&mut [$crate::Vec3<$scalar>]>,
        ) {
            let order =
                if normals.is_some() { $crate::Order::First } else { $crate::Order::Zero };
            for (i, &u) in us.iter().enumerate() {
                for (j, &v) in vs.iter().enumerate() {
                    let k = i * vs.len() + j;
                    let (u, v) = (<$scalar>::from(u), <$scalar>::from(v));
                    let jet = $crate::Surface::jet(self, u, v, order);
                    points[k] = jet.p;
                    if let Some(normals) = normals.as_deref_mut() {
                        normals[k] = jet.normal();
                    }
                }
            }
        }
    };
    (@ line $scalar:ty) => {
        fn line(
            &self,
            u: $scalar,
            vs: &[f64],
            order: $crate::Order,
        ) -> Vec<$crate::SurfJet<$scalar>> {
            let at = |v: &f64| $crate::Surface::jet(self, u, <$scalar>::from(*v), order);
            vs.iter().map(at).collect()
        }
    };
    (@ scattered $scalar:ty) => {
        fn scattered(&self, uv: &[[f64; 2]], out: &mut [$crate::Vec3<$scalar>]) {
            for (x, &[u, v]) in out.iter_mut().zip(uv) {
                let (u, v) = (<$scalar>::from(u), <$scalar>::from(v));
                *x = $crate::Surface::jet(self, u, v, $crate::Order::Zero).p;
            }
        }
    };
}

/// The usual methods of a field: `value_with_gradient`, the value from value and gradient;
/// `second_by_differences`, second derivatives by differences; `no_bounds`, no bounds of its values
/// over a box.
#[macro_export]
macro_rules! field_facts {
    ($scalar:ty: $($which:ident),+ $(,)?) => {
        $($crate::field_facts!(@ $which $scalar);)+
    };
    (@ value_with_gradient $scalar:ty) => {
        fn value(&self, p: $crate::Vec3<$scalar>) -> $scalar {
            $crate::Field::value_and_gradient(self, p).0
        }
    };
    (@ second_by_differences $scalar:ty) => {
        fn second_order(
            &self,
            p: $crate::Vec3<$scalar>,
        ) -> ($scalar, $crate::Vec3<$scalar>, [$crate::Vec3<$scalar>; 3]) {
            $crate::field_differences(self, p)
        }
    };
    (@ no_bounds $scalar:ty) => {
        fn bounds(&self, _: &$crate::Box3) -> Option<[f64; 2]> {
            None
        }
    };
}
