//! Primitive solids: as functions and as meshes. All are centred on `center`, with their axis along z.

use glam::DVec3;
use serde::Deserialize;

use crate::field::{Graph, NodeId, System};
use crate::{Error, Mesh, primitives};

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

    /// The length of the diagonal of the box around the primitive.
    pub(super) fn diagonal(&self) -> f64 {
        let size = match self {
            Self::Box { low, high } => *high - *low,
            Self::Sphere { radius, .. } => DVec3::splat(2.0 * radius),
            Self::Cone { bottom, top, height, .. } => {
                let width = 2.0 * bottom.max(*top);
                DVec3::new(width, width, *height)
            }
            Self::Torus { radius, tube, .. } => {
                let width = 2.0 * (radius + tube);
                DVec3::new(width, width, 2.0 * tube)
            }
        };
        size.length()
    }

    /// A closed mesh whose flat facets are within `tolerance` of the round surface, corners on it.
    pub(super) fn mesh(&self, tolerance: f64) -> Result<Mesh, Error> {
        // Where a surface bends both ways each bend may use half of the tolerance.
        let half = tolerance * 0.5;
        Ok(match self {
            Self::Box { low, high } => primitives::cuboid(low.to_array(), high.to_array())?,
            Self::Sphere { center, radius } => {
                let slices = segments(*radius, half);
                primitives::uv_sphere(*radius, slices, slices.div_ceil(2))?.translated(center.to_array())
            }
            Self::Cone { center, bottom, top, height } => {
                let slices = segments(bottom.max(*top), tolerance);
                primitives::frustum(*bottom, *top, *height, slices)?
                    .translated((*center - DVec3::new(0.0, 0.0, height * 0.5)).to_array())
            }
            Self::Torus { center, radius, tube } => {
                primitives::torus(*radius, *tube, segments(radius + tube, half), segments(*tube, half))?
                    .translated(center.to_array())
            }
        })
    }
}

/// Chords around a circle that stay within `tolerance` of it.
fn segments(radius: f64, tolerance: f64) -> u32 {
    let half_angle = (1.0 - (tolerance / radius).min(0.5)).acos();
    (std::f64::consts::PI / half_angle).ceil().clamp(8.0, 4096.0) as u32
}
