//! The numbers of things: one type for each kind, so that none is taken for another.

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(transparent)]
        pub(crate) struct $name(u32);

        #[allow(dead_code, reason = "every kind of number has the same vocabulary")]
        impl $name {
            /// Stands for "there is none" in tables, where an `Option` would take twice the memory.
            pub(crate) const NONE: Self = Self(u32::MAX);

            #[inline(always)]
            pub(crate) const fn new(number: u32) -> Self {
                Self(number)
            }

            /// The bare number.
            #[inline(always)]
            pub(crate) const fn number(self) -> u32 {
                self.0
            }

            /// The place in a table that has an entry for each.
            #[inline(always)]
            pub(crate) const fn index(self) -> usize {
                self.0 as usize
            }

            /// The number, unless it is [`NONE`](Self::NONE).
            #[inline(always)]
            pub(crate) fn get(self) -> Option<Self> {
                (self != Self::NONE).then_some(self)
            }
        }
    )*};
}

ids! {
    /// A vertex of either operand: those of A come first, then those of B, then ends of rays.
    VertexId;
    /// A triangle of either operand: those of A come first.
    FaceId;
    /// A crossing: those on edges of A come first.
    NodeId;
    /// A point of the arrangement: vertices come first, then nodes, then points added later.
    PointId;
    /// A segment of the intersection curve.
    SegmentId;
    /// An edge that is cut: those of A come first.
    CutEdgeId;
    /// A cut face: its place among those of its operand.
    CutFaceId;
    /// An edge of any number of surfaces (see `general`).
    EdgeId;
    /// A point in which three faces meet.
    TripleId;
    /// A vector of winding numbers.
    LabelId;
}
