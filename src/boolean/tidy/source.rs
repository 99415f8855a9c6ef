//! What the clean-up asks the rest of the pipeline: this file is the only one that knows the arrangement.
//!
//! Its points are the vertices of both operands and the nodes, under their common numbers; everything else in this room
//! speaks of the points of a [`Patch`](super::patch::Patch).

use crate::boolean::arrangement::identify::Identification;
use crate::boolean::arrangement::points::Points;
use crate::boolean::classify::body::Body;
use crate::boolean::complex::ids::{FaceId, PointId, VertexId};
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::rounding::Rounding;
use crate::boolean::general::shape::Shape;
use crate::exact::Projection;

/// An uncut triangle that the result keeps.
pub(super) struct KeptTriangle {
    /// Its vertices, or the points that stand for them, as the operand has them.
    pub(super) points: [PointId; 3],
    /// Where it comes from, and whether the result turns it over.
    pub(super) origin: Origin,
    /// How often the result has it.
    pub(super) copies: u32,
    /// Whether its multiplicity is 1: the result has it as the part of the operand does.
    pub(super) is_simple: bool,
}

/// What is cleaned up: one body of two operands, or one result of the general arrangement.
#[derive(Clone, Copy)]
pub(crate) enum Ground<'a> {
    Body(Body<'a>),
    /// Its faces are those of one operand, the whole complex.
    Shape(&'a Shape<'a>),
}

/// The ground with what the clean-up is to know of it.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) ground: Ground<'a>,
    /// Edges and heights that rounding can make.
    pub(super) rounding: Rounding,
    /// Whether the operands touch: plain coordinates left some decision open.
    pub(super) has_contacts: bool,
    /// Pairs of faces in one plane but for rounding, if what is so is to become one face.
    pub(super) nearly_flush: &'a [[FaceId; 2]],
}

impl<'a> Source<'a> {
    /// Number of vertices of all operands: the points numbered first.
    pub(super) fn vertex_count(&self) -> u32 {
        match self.ground {
            Ground::Body(body) => body.complex().vertex_count(),
            Ground::Shape(shape) => shape.general.surfaces.vertex_count(),
        }
    }

    /// Number of points of the arrangement.
    pub(super) fn point_count(&self) -> usize {
        match self.ground {
            Ground::Body(body) => body.arrangement.points.len(),
            Ground::Shape(shape) => shape.next().index(),
        }
    }

    /// Where a point of the arrangement is.
    pub(super) fn position(&self, point: PointId) -> [f64; 3] {
        match self.ground {
            Ground::Body(body) => *body.arrangement.points.position(point),
            Ground::Shape(shape) => *shape.position(point),
        }
    }

    /// Number of triangles of an operand.
    pub(super) fn triangle_count(&self, operand: usize) -> usize {
        match self.ground {
            Ground::Body(body) => body.complex().operands[operand].triangles.len(),
            Ground::Shape(shape) => [shape.general.surfaces.face_count() as usize, 0][operand],
        }
    }

    fn identification(&self) -> &'a Identification {
        match self.ground {
            Ground::Body(body) => &body.arrangement.identification,
            Ground::Shape(shape) => &shape.general.identification,
        }
    }

    /// The points that stand for others at the same place, ascending.
    pub(super) fn representatives(&self) -> Vec<PointId> {
        self.identification().representatives()
    }

    /// The nodes on edges between faces of one plane.
    pub(super) fn points_on_coplanar_edges(&self) -> Vec<PointId> {
        match self.ground {
            Ground::Body(Body { arrangement, .. }) => {
                let nodes = arrangement.plane_faces.nodes_on_coplanar_edges();
                nodes.iter().map(|&node| arrangement.points.of_node(node)).collect()
            }
            Ground::Shape(shape) => shape.points_on_coplanar_edges(),
        }
    }

    /// Vertices at which whole faces may have to come apart: those on edges of more than two faces.
    pub(super) fn points_on_pinched_edges(&self) -> Vec<PointId> {
        match self.ground {
            // Such operands are taken apart before.
            Ground::Body(_) => Vec::new(),
            Ground::Shape(shape) => shape.points_on_pinched_edges(),
        }
    }

    /// Whether cutting can have left anything to clean up: points that became one, nodes on coplanar edges, or surface that
    /// counts other than once. O(vertices + nodes).
    pub(super) fn needs_clean_up(&self) -> bool {
        if !self.identification().is_empty() {
            return true;
        }
        match self.ground {
            Ground::Body(Body { arrangement, windings, .. }) => {
                !arrangement.plane_faces.nodes_on_coplanar_edges().is_empty()
                    || windings.have_repeats(&arrangement.curve)
            }
            Ground::Shape(_) => true,
        }
    }

    /// The triangle that a face comes from, turned over if the face was, and how it is projected: counter-clockwise, along
    /// the axis it looks along most.
    pub(super) fn source_and_projection(&self, origin: Origin) -> ([[f64; 3]; 3], Projection) {
        let source = match self.ground {
            Ground::Body(body) => body.complex().source(origin),
            Ground::Shape(shape) => shape.source(origin),
        };
        (source, Projection::of(&source))
    }

    /// The points that stand for the vertices of a face.
    pub(super) fn points_of_face(&self, face: FaceId) -> [PointId; 3] {
        let vertices = match self.ground {
            Ground::Body(body) => {
                let (operand, triangle) = body.complex().triangle(face);
                let corners = body.complex().operands[operand].triangles[triangle as usize];
                corners.map(|v| body.complex().vertex(operand, v))
            }
            Ground::Shape(shape) => shape.general.surfaces.vertices(face),
        };
        vertices.map(|vertex| self.point_of_vertex(vertex))
    }

    /// The point that stands for a vertex.
    pub(super) fn point_of_vertex(&self, vertex: VertexId) -> PointId {
        self.identification().representative(Points::of_vertex(vertex))
    }

    /// What comes from a face and looks its way.
    pub(super) fn origin(&self, face: FaceId) -> Origin {
        match self.ground {
            Ground::Body(body) => body.complex().origin(face, false),
            Ground::Shape(shape) => shape.origin(face, false),
        }
    }

    /// The operand that a face comes from, of all there are.
    pub(super) fn owner(&self, origin: Origin) -> u32 {
        match self.ground {
            Ground::Body(_) => origin.operand,
            Ground::Shape(shape) => shape.general.surfaces.owner(FaceId::new(origin.triangle)),
        }
    }

    /// Whether two faces look the same way from one plane and belong to one group: the edge between them is coplanar, and
    /// nothing is lost with it.
    pub(super) fn are_mergeable(&self, x: Origin, y: Origin) -> bool {
        match self.ground {
            Ground::Body(body) => body.complex().are_mergeable(x, y),
            Ground::Shape(shape) => shape.are_mergeable(x, y),
        }
    }

    /// Whether two faces lie in one plane, exactly.
    pub(super) fn are_coplanar(&self, x: Origin, y: Origin) -> bool {
        match self.ground {
            Ground::Body(body) => body.complex().are_coplanar(x, y),
            Ground::Shape(shape) => shape.are_coplanar(x, y),
        }
    }

    /// Whether what is cut from two faces of one plane may be one face.
    pub(super) fn belong_together(&self, x: Origin, y: Origin) -> bool {
        match self.ground {
            Ground::Body(body) => body.complex().belong_together(x, y),
            Ground::Shape(shape) => shape.belong_together(x, y),
        }
    }

    /// Whether three points lay on one line before they were rounded; false if one of them is a copy.
    pub(super) fn were_collinear(&self, points: [PointId; 3]) -> bool {
        match self.ground {
            Ground::Body(body) => body.arrangement.were_on_one_line(points),
            Ground::Shape(shape) => shape.were_collinear(points),
        }
    }

    /// Calls `visit` for every uncut triangle of the result, in order. O(triangles).
    pub(super) fn for_each_kept(&self, mut visit: impl FnMut(&KeptTriangle)) {
        match self.ground {
            Ground::Body(body) => for_each_kept_of_body(body, visit),
            Ground::Shape(shape) => shape.for_each_kept(|face, points, count| {
                let reversed = count < 0;
                visit(&KeptTriangle {
                    points,
                    origin: shape.origin(face, reversed),
                    copies: count.unsigned_abs(),
                    is_simple: count == 1,
                });
            }),
        }
    }
}

fn for_each_kept_of_body(body: Body<'_>, mut visit: impl FnMut(&KeptTriangle)) {
    let complex = body.complex();
    let identification = &body.arrangement.identification;
    for &part in body.parts {
        let windings = body.windings.of_operand(part.operand);
        let faces = &body.arrangement.curve.faces[part.operand];
        for (triangle, corners) in (0..).zip(complex.operands[part.operand].triangles) {
            if faces.is_cut(triangle) {
                continue;
            }
            let count = part.multiplicity(windings[corners[0] as usize]);
            if count == 0 {
                continue;
            }
            let reversed = part.reversed != (count < 0);
            let point = |v: u32| Points::of_vertex(complex.vertex(part.operand, v));
            visit(&KeptTriangle {
                points: corners.map(|v| identification.representative(point(v))),
                origin: Origin { operand: part.operand as u32, triangle, reversed },
                copies: count.unsigned_abs(),
                is_simple: count == 1,
            });
        }
    }
}
