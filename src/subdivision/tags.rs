//! What is sharp on a cage.

/// An edge that stays sharp under subdivision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    /// Its ends, the lower first.
    pub edge: [u32; 2],
    /// How many subdivisions it stays sharp; infinite: for ever. Values of 10 and more count as infinite.
    pub sharpness: f64,
}

/// A vertex that stays where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The vertex.
    pub vertex: u32,
    /// As a crease's.
    pub sharpness: f64,
}

/// The faces between two creases at a corner, and how they open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sector {
    /// The corner.
    pub vertex: u32,
    /// The other end of the sector's first crease, counter-clockwise seen from outside.
    pub first: u32,
    /// The angle that the limit surface spans, in radians: below pi a convex corner, above a concave one.
    pub angle: f64,
    /// How strongly the ring is pulled into a plane at each step: 0 for not at all, 1 for entirely.
    pub flatness: f64,
}

/// The tags of a cage, each list sorted and without duplicates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tags {
    /// Sharp edges.
    pub creases: Vec<Crease>,
    /// Sharp vertices.
    pub corners: Vec<Corner>,
    /// Sectors whose angle is not the usual one of a convex corner.
    pub sectors: Vec<Sector>,
}

/// From here on a sharpness is infinite, as in OpenSubdiv.
pub const INFINITE_SHARPNESS: f64 = 10.0;

impl Tags {
    /// Whether nothing is tagged.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.creases.is_empty() && self.corners.is_empty() && self.sectors.is_empty()
    }

    /// Lists in their order, ends of edges too; of several sharpnesses of one place the largest; sharpness 0 left out and from
    /// [`INFINITE_SHARPNESS`] on made infinite.
    pub(crate) fn normalised(mut self) -> Self {
        let raised = |sharpness: f64| if sharpness >= INFINITE_SHARPNESS { f64::INFINITY } else { sharpness };
        for crease in &mut self.creases {
            crease.edge.sort_unstable();
            crease.sharpness = raised(crease.sharpness);
        }
        for corner in &mut self.corners {
            corner.sharpness = raised(corner.sharpness);
        }
        self.creases.retain(|crease| crease.sharpness > 0.0);
        self.corners.retain(|corner| corner.sharpness > 0.0);
        self.creases.sort_by(|a, b| a.edge.cmp(&b.edge).then(b.sharpness.total_cmp(&a.sharpness)));
        self.creases.dedup_by_key(|crease| crease.edge);
        self.corners.sort_by(|a, b| a.vertex.cmp(&b.vertex).then(b.sharpness.total_cmp(&a.sharpness)));
        self.corners.dedup_by_key(|corner| corner.vertex);
        self.sectors.sort_by_key(|sector| (sector.vertex, sector.first));
        self.sectors.dedup_by_key(|sector| (sector.vertex, sector.first));
        self
    }
}
