// Rays at edges and vertices of triangles, hundreds of millions of them: the side on which each passes, by signs of
// integers.
#pragma once

#include <vector>

#include "exact/draw.hpp"
#include "exact/primitives.hpp"

namespace lostbits::exact {

/// Signs that say how a line passes the plane and the edges of a triangle.
struct PassingRay {
    int across = 0;                                             ///< 0: beside the plane or in it
    int edges[3] = {};                                          ///< of each edge: inside of it, on it, or outside
    int ahead = 0;                                              ///< of the plane, as seen from the origin of the ray
    enum { two_words, four_words, any_length } by = two_words;  ///< the numbers that it took

    [[nodiscard]] bool meets() const {
        return across != 0 && edges[0] >= 0 && edges[1] >= 0 && edges[2] >= 0 && ahead >= 0;
    }
    /// Number of edges that are hit: two at a vertex.
    [[nodiscard]] int touched() const { return !meets() ? 0 : (edges[0] == 0) + (edges[1] == 0) + (edges[2] == 0); }
};
PassingRay pass(const Problem& triangle);

/// Rays at a point of an edge or at a vertex, from a thousandth to a million lengths of the triangle away, in floats or
/// doubles: of fifteen in sixteen the direction is rounded, and most of these are moved by up to two ulps in each
/// component; the others have numbers on a grid with which they meet the point exactly, and three in four of these have
/// one number that is moved. Triangles are tiny, large, slivers and needles.
void draw_at_edges(bool floats, Chance& chance, std::vector<Problem>& problems);

}  // namespace lostbits::exact
