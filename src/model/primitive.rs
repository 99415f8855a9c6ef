//! Primitive solids: as functions and as meshes. All are centred on `center`, with their axis along z.

use glam::{DVec2, DVec3};
use serde::Deserialize;

use crate::Mesh;
use crate::field::{Graph, NodeId, System};

#[derive(Clone, Debug)]
pub(super) enum Primitive {
    Box {
        low: DVec3,
        high: DVec3,
    },
    Sphere {
        center: DVec3,
        radius: f64,
    },
    /// Also a cylinder, with equal radii.
    Cone {
        center: DVec3,
        bottom: f64,
        top: f64,
        height: f64,
    },
    Torus {
        center: DVec3,
        radius: f64,
        tube: f64,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxFields {
    low: Option<[f64; 3]>,
    high: Option<[f64; 3]>,
    size: Option<[f64; 3]>,
    center: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SphereFields {
    radius: f64,
    #[serde(default)]
    center: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CylinderFields {
    radius: f64,
    height: f64,
    #[serde(default)]
    center: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConeFields {
    radius: f64,
    #[serde(default)]
    top_radius: f64,
    height: f64,
    #[serde(default)]
    center: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TorusFields {
    radius: f64,
    tube: f64,
    #[serde(default)]
    center: [f64; 3],
}

/// The primitive of that kind, nothing if there is no such kind.
pub(super) fn parse(kind: &str, fields: serde_json::Value) -> Option<Result<Primitive, String>> {
    fn read<T: serde::de::DeserializeOwned>(fields: serde_json::Value) -> Result<T, String> {
        serde_json::from_value(fields).map_err(|error| error.to_string())
    }
    let parsed = match kind {
        "box" => read(fields).and_then(|fields| from_box(&fields)),
        "sphere" => read(fields).map(|f: SphereFields| Primitive::Sphere {
            center: DVec3::from_array(f.center),
            radius: f.radius,
        }),
        "cylinder" => read(fields).map(|f: CylinderFields| Primitive::Cone {
            center: DVec3::from_array(f.center),
            bottom: f.radius,
            top: f.radius,
            height: f.height,
        }),
        "cone" => read(fields).map(|f: ConeFields| Primitive::Cone {
            center: DVec3::from_array(f.center),
            bottom: f.radius,
            top: f.top_radius,
            height: f.height,
        }),
        "torus" => read(fields).map(|f: TorusFields| Primitive::Torus {
            center: DVec3::from_array(f.center),
            radius: f.radius,
            tube: f.tube,
        }),
        _ => return None,
    };
    Some(parsed.and_then(checked))
}

fn from_box(fields: &BoxFields) -> Result<Primitive, String> {
    match (fields.low, fields.high, fields.size, fields.center) {
        (Some(low), Some(high), None, None) => {
            Ok(Primitive::Box { low: DVec3::from_array(low), high: DVec3::from_array(high) })
        }
        (None, None, Some(size), center) => {
            let (half, center) =
                (DVec3::from_array(size) * 0.5, DVec3::from_array(center.unwrap_or_default()));
            Ok(Primitive::Box { low: center - half, high: center + half })
        }
        _ => Err("a box needs `low` and `high`, or `size` and perhaps `center`".to_owned()),
    }
}

fn checked(primitive: Primitive) -> Result<Primitive, String> {
    let positive = |value: f64| value > 0.0 && value.is_finite();
    let fault = match &primitive {
        Primitive::Box { low, high } if !(low.is_finite() && high.is_finite() && low.cmplt(*high).all()) => {
            "the box is empty: every coordinate of `low` must be below that of `high`"
        }
        Primitive::Sphere { radius, .. } if !positive(*radius) => "the radius must be positive",
        Primitive::Cone { bottom, top, height, .. } => {
            let radii = *bottom >= 0.0 && *top >= 0.0 && positive(bottom + top);
            if !radii {
                "the radii must not be negative, nor both zero"
            } else if !positive(*height) {
                "the height must be positive"
            } else {
                return Ok(primitive);
            }
        }
        Primitive::Torus { radius, tube, .. } if !(positive(*radius) && positive(*tube)) => {
            "the radii must be positive"
        }
        Primitive::Torus { radius, tube, .. } if tube >= radius => {
            "the tube's radius must be less than the torus's, or the surface crosses itself"
        }
        _ => return Ok(primitive),
    };
    Err(fault.to_owned())
}

impl Primitive {
    /// A function positive inside: the distance where it is that of a sphere, a torus or one face, minima of those
    /// otherwise.
    pub(super) fn field(&self, graph: &mut Graph) -> NodeId {
        let center = match self {
            Self::Box { low, high } => (*low + *high) * 0.5,
            Self::Sphere { center, .. } | Self::Cone { center, .. } | Self::Torus { center, .. } => *center,
        };
        let axes = graph.axes();
        let [x, y, z] = [0, 1, 2].map(|k| {
            let middle = graph.constant(center[k]);
            graph.sub(axes[k], middle)
        });
        let length = |graph: &mut Graph, components: &[NodeId]| {
            let squares: Vec<NodeId> = components.iter().map(|&c| graph.square(c)).collect();
            let sum = squares[1..].iter().fold(squares[0], |a, &b| graph.add(a, b));
            graph.sqrt(sum)
        };
        let below = |graph: &mut Graph, limit: f64, value: NodeId| {
            let limit = graph.constant(limit);
            graph.sub(limit, value)
        };
        match self {
            Self::Box { low, high } => {
                let half = (*high - *low) * 0.5;
                let sides = [(x, half.x), (y, half.y), (z, half.z)].map(|(axis, half)| {
                    let size = graph.abs(axis);
                    below(graph, half, size)
                });
                let first = graph.and(System::R1, sides[0], sides[1]);
                graph.and(System::R1, first, sides[2])
            }
            Self::Sphere { radius, .. } => {
                let distance = length(graph, &[x, y, z]);
                below(graph, *radius, distance)
            }
            Self::Cone { bottom, top, height, .. } => {
                let around = length(graph, &[x, y]);
                // The radius at height z, and the wall's slope, so that the function is the distance from the wall.
                let slope = (top - bottom) / height;
                let middle = graph.constant((top + bottom) * 0.5);
                let slope_node = graph.constant(slope);
                let change = graph.mul(slope_node, z);
                let radius = graph.add(middle, change);
                let gap = graph.sub(radius, around);
                let cosine = graph.constant(1.0 / slope.hypot(1.0));
                let wall = graph.mul(gap, cosine);
                let size = graph.abs(z);
                let ends = below(graph, height * 0.5, size);
                graph.and(System::R1, wall, ends)
            }
            Self::Torus { radius, tube, .. } => {
                let around = length(graph, &[x, y]);
                let ring = graph.constant(*radius);
                let off = graph.sub(around, ring);
                let distance = length(graph, &[off, z]);
                below(graph, *tube, distance)
            }
        }
    }

    /// A closed mesh whose flat facets are within `tolerance` of the round surface, corners on it.
    pub(super) fn mesh(&self, tolerance: f64) -> Mesh {
        match self {
            Self::Box { low, high } => cuboid(*low, *high),
            Self::Sphere { center, radius } => {
                let steps = segments(*radius, tolerance * 0.5).div_ceil(2).max(3);
                let profile: Vec<DVec2> = (0..=steps)
                    .map(|k| {
                        let angle = std::f64::consts::PI * f64::from(k) / f64::from(steps);
                        DVec2::new(radius * angle.sin(), -radius * angle.cos())
                    })
                    .collect();
                revolved(&profile, false, segments(*radius, tolerance * 0.5), *center)
            }
            Self::Cone { center, bottom, top, height } => {
                let half = height * 0.5;
                let mut profile: Vec<DVec2> =
                    [(0.0, -half), (*bottom, -half), (*top, half), (0.0, half)].map(DVec2::from).to_vec();
                // A pointed end has its point once.
                profile.dedup();
                revolved(&profile, false, segments(bottom.max(*top), tolerance), *center)
            }
            Self::Torus { center, radius, tube } => {
                let steps = segments(*tube, tolerance * 0.5);
                let profile: Vec<DVec2> = (0..steps)
                    .map(|k| {
                        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(steps);
                        DVec2::new(radius + tube * angle.cos(), tube * angle.sin())
                    })
                    .collect();
                revolved(&profile, true, segments(radius + tube, tolerance * 0.5), *center)
            }
        }
    }
}

/// Chords round a circle that stay within `tolerance` of it.
fn segments(radius: f64, tolerance: f64) -> u32 {
    let half_angle = (1.0 - (tolerance / radius).min(0.5)).acos();
    (std::f64::consts::PI / half_angle).ceil().clamp(8.0, 4096.0) as u32
}

fn cuboid(low: DVec3, high: DVec3) -> Mesh {
    let corner = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { low[axis] } else { high[axis] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles)
}

/// The profile (distance from the axis, height), with the solid on its left, turned about the z axis. Ends of an open
/// profile are on the axis.
fn revolved(profile: &[DVec2], closed: bool, count: u32, center: DVec3) -> Mesh {
    let mut mesh = Mesh::default();
    // The first vertex of each profile point, and whether it is a whole ring.
    let mut rings: Vec<(u32, bool)> = Vec::new();
    for (index, point) in profile.iter().enumerate() {
        let first = mesh.positions.len() as u32;
        let on_axis = point.x == 0.0 || (!closed && (index == 0 || index + 1 == profile.len()));
        if on_axis {
            mesh.positions.push((center + DVec3::new(0.0, 0.0, point.y)).to_array());
        } else {
            mesh.positions.extend((0..count).map(|k| {
                let (sine, cosine) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
                (center + DVec3::new(point.x * cosine, point.x * sine, point.y)).to_array()
            }));
        }
        rings.push((first, !on_axis));
    }
    let pairs = if closed { profile.len() } else { profile.len() - 1 };
    for k in 0..pairs {
        let ((a, ring_a), (b, ring_b)) = (rings[k], rings[(k + 1) % profile.len()]);
        for step in 0..count {
            let next = (step + 1) % count;
            match (ring_a, ring_b) {
                (true, true) => {
                    mesh.triangles.push([a + step, a + next, b + next]);
                    mesh.triangles.push([a + step, b + next, b + step]);
                }
                (true, false) => mesh.triangles.push([a + step, a + next, b]),
                (false, true) => mesh.triangles.push([a, b + next, b + step]),
                (false, false) => {}
            }
        }
    }
    mesh
}
