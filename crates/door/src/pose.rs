//! Vectors, matrices and poses.

pub(crate) type Vector = [f64; 3];

pub(crate) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn scaled(a: Vector, factor: f64) -> Vector {
    a.map(|x| x * factor)
}

pub(crate) fn sub(a: Vector, b: Vector) -> Vector {
    add(a, scaled(b, -1.0))
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The unit vector along `a`, unless `a` is zero or not finite.
pub(crate) fn unit(a: Vector) -> Option<Vector> {
    let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let a = scaled(a, 1.0 / largest);
    Some(scaled(a, 1.0 / length(a)))
}

/// A unit vector perpendicular to the unit vector `a`.
pub(crate) fn perpendicular([x, y, z]: Vector) -> Vector {
    let across = if x.abs() <= y.abs().min(z.abs()) {
        [0.0, -z, y]
    } else if y.abs() <= z.abs() {
        [z, 0.0, -x]
    } else {
        [-y, x, 0.0]
    };
    unit(across).unwrap_or([1.0, 0.0, 0.0])
}

/// A matrix by rows: a rotation, or a tensor of inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Matrix(pub(crate) [Vector; 3]);

impl Matrix {
    pub(crate) const ZERO: Self = Self([[0.0; 3]; 3]);
    pub(crate) const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// The tensor with the elements xx, yy, zz, xy, xz, yz.
    pub(crate) fn symmetric([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> Self {
        Self([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    }

    pub(crate) fn diagonal([x, y, z]: Vector) -> Self {
        Self::symmetric([x, y, z, 0.0, 0.0, 0.0])
    }

    /// The rotation about a unit axis.
    pub(crate) fn about(axis: Vector, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let [x, y, z] = scaled(axis, sin);
        let skew = Self([[cos, -z, y], [z, cos, -x], [-y, x, cos]]);
        Self::outer(axis, axis).scaled(1.0 - cos).plus(skew)
    }

    /// The rotation of a quaternion w, x, y, z, which need not have the norm 1.
    pub(crate) fn quaternion([w, x, y, z]: [f64; 4]) -> Option<Self> {
        let norm = (w * w + x * x + y * y + z * z).sqrt();
        if !(norm > 1e-12 && norm.is_finite()) {
            return None;
        }
        let [w, x, y, z] = [w, x, y, z].map(|v| v / norm);
        let skew = Self([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]);
        let twice = skew.scaled(w).plus(skew.times(skew)).scaled(2.0);
        Some(Self::IDENTITY.plus(twice))
    }

    /// Turns about the fixed axes x, y and z in this order.
    pub(crate) fn roll_pitch_yaw(angles: Vector) -> Self {
        let turn = |k: usize| Self::about(Self::IDENTITY.column(k), angles[k]);
        turn(2).times(turn(1)).times(turn(0))
    }

    /// The rotation that turns z along the unit vector `axis`.
    pub(crate) fn z_along(axis: Vector) -> Self {
        let x = perpendicular(axis);
        Self([x, cross(axis, x), axis]).transposed()
    }

    pub(crate) fn outer(a: Vector, b: Vector) -> Self {
        Self(a.map(|x| scaled(b, x)))
    }

    pub(crate) fn column(self, k: usize) -> Vector {
        self.0.map(|row| row[k])
    }

    pub(crate) fn transposed(self) -> Self {
        Self([self.column(0), self.column(1), self.column(2)])
    }

    pub(crate) fn apply(self, v: Vector) -> Vector {
        self.0.map(|row| dot(row, v))
    }

    pub(crate) fn times(self, other: Self) -> Self {
        Self(self.0.map(|row| other.transposed().apply(row)))
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        let [a, b, c] = self.0;
        let [d, e, f] = other.0;
        Self([add(a, d), add(b, e), add(c, f)])
    }

    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self(self.0.map(|row| scaled(row, factor)))
    }

    /// This tensor in the axes of which `turn` is the rotation: R I Rᵀ.
    pub(crate) fn turned(self, turn: Self) -> Self {
        turn.times(self).times(turn.transposed())
    }
}

/// Where a frame is in another: origin and axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub(crate) origin: Vector,
    pub(crate) turn: Matrix,
}

impl Pose {
    pub(crate) const IDENTITY: Self = Self {
        origin: [0.0; 3],
        turn: Matrix::IDENTITY,
    };

    pub(crate) fn new(origin: Vector, turn: Matrix) -> Self {
        Self { origin, turn }
    }

    /// A frame whose z is along the unit vector `axis`.
    pub(crate) fn along(origin: Vector, axis: Vector) -> Self {
        Self::new(origin, Matrix::z_along(axis))
    }

    /// A pose in this frame, seen from outside.
    pub(crate) fn then(self, inner: Self) -> Self {
        Self::new(self.point(inner.origin), self.turn.times(inner.turn))
    }

    pub(crate) fn point(self, local: Vector) -> Vector {
        add(self.origin, self.turn.apply(local))
    }

    pub(crate) fn inverse(self) -> Self {
        let turn = self.turn.transposed();
        Self::new(scaled(turn.apply(self.origin), -1.0), turn)
    }

    /// A turn about an axis through a point of the same frame.
    pub(crate) fn turn_about(point: Vector, turn: Matrix) -> Self {
        Self::new(sub(point, turn.apply(point)), turn)
    }
}
