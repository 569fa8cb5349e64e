#include "exact/draw.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lostbits::exact {
namespace {

using Matrix = std::array<double, 12>;
using Triple = std::array<double, 3>;

double& at(Matrix& m, std::size_t row, std::size_t column) { return m[4 * row + column]; }
double at(const Matrix& m, std::size_t row, std::size_t column) { return m[4 * row + column]; }

/// A v.
Triple times(const Matrix& m, const Triple& v) {
    Triple sum{};
    for (std::size_t i = 0; i < 3; ++i) sum[i] = at(m, i, 0) * v[0] + at(m, i, 1) * v[1] + at(m, i, 2) * v[2];
    return sum;
}

/// A⁻¹ without its translation. If A has small whole numbers and a power of two as its determinant, no operation
/// rounds.
Matrix inverse_of(const Matrix& m) {
    Matrix inverse{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
            at(inverse, c, i) = at(m, j, d) * at(m, k, e) - at(m, j, e) * at(m, k, d);
        }
    }
    const double det =
        at(m, 0, 0) * at(inverse, 0, 0) + at(m, 0, 1) * at(inverse, 1, 0) + at(m, 0, 2) * at(inverse, 2, 0);
    for (double& x : inverse) x /= det;
    return inverse;
}

int orientation_of(const Matrix& m) {
    Vector<Whole> rows[3];
    for (std::size_t i = 0; i < 3; ++i) rows[i] = {Whole(at(m, i, 0)), Whole(at(m, i, 1)), Whole(at(m, i, 2))};
    return sign(dot(rows[0], cross(rows[1], rows[2])));
}

Matrix random_matrix(Chance& chance) {
    Matrix m{};
    const int family = chance.below(4);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) at(m, i, c) = 2 * chance.part();
        at(m, i, 3) = (family == 1 ? 1e6 : 9) * chance.part();
    }
    for (std::size_t c = 0; c < 3 && family == 2; ++c) at(m, 2, c) = at(m, 0, c) + at(m, 1, c) + 1e-12 * chance.part();
    for (std::size_t i = 0; i < 3 && family == 3; ++i) {
        const double along = std::ldexp(1 + std::fabs(chance.part()), chance.below(40) - 20);
        for (std::size_t c = 0; c < 3; ++c) at(m, i, c) = c == i ? along : 0;
    }
    return m;
}

/// Rows are added to others up to twice, exchanged, and multiplied by powers of two.
Matrix made_matrix(Chance& chance) {
    Matrix m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    for (int steps = chance.below(5); steps > 0; --steps) {
        const auto i = static_cast<std::size_t>(chance.below(3)),
                   j = (i + 1 + static_cast<std::size_t>(chance.below(2))) % 3;
        const double factor = static_cast<double>(chance.below(5) - 2);
        const int power = chance.below(5) - 2;
        for (std::size_t c = 0; c < 3; ++c) {
            if (steps % 3 == 0) std::swap(at(m, i, c), at(m, j, c));
            else if (steps % 3 == 1) at(m, i, c) += factor * at(m, j, c);
            else at(m, i, c) = std::ldexp(at(m, i, c), power);
        }
    }
    const bool shifts = chance.below(2) == 0;
    for (std::size_t i = 0; i < 3 && shifts; ++i) at(m, i, 3) = static_cast<double>(chance.below(9) - 4);
    return m;
}

/// Negates a row if the determinant has the other sign.
void turn(Matrix& m, int orientation) {
    if (orientation_of(m) == -orientation)
        for (std::size_t c = 0; c < 3; ++c) at(m, 0, c) = -at(m, 0, c);
}

/// True if matrix and ray are numbers, the ray has a direction, and the matrix is of the kind.
template <class S>
bool has_valid_transform(const Problem& problem, int orientation) {
    const auto is_number = [](double x) { return std::isfinite(static_cast<S>(x)); };
    return std::ranges::all_of(problem.matrix, is_number) && std::ranges::all_of(problem.ray, is_number) &&
           !(problem.ray[3] == 0 && problem.ray[4] == 0 && problem.ray[5] == 0) &&
           orientation_of(problem.matrix) == orientation;
}

/// The problem with the transform, with its ray transformed to the world.
template <class S>
Problem transform(Problem p, Matrix m, bool is_inverse) {
    for (double& x : m) x = stored<S>(x);
    const Triple shift{at(m, 0, 3), at(m, 1, 3), at(m, 2, 3)};
    Triple o{p.ray[0], p.ray[1], p.ray[2]}, d{p.ray[3], p.ray[4], p.ray[5]};
    if (is_inverse) {
        const Matrix back = inverse_of(m);
        for (std::size_t i = 0; i < 3; ++i) o[i] -= shift[i];
        o = times(back, o), d = times(back, d);
    } else {
        o = times(m, o), d = times(m, d);
        for (std::size_t i = 0; i < 3; ++i) o[i] += shift[i];
    }
    for (std::size_t i = 0; i < 3; ++i) p.ray[i] = stored<S>(o[i]), p.ray[i + 3] = stored<S>(d[i]);
    p.matrix = m, p.has_transform = true, p.is_inverse = is_inverse;
    return p;
}

/// Places each primitive by a drawn matrix whose result the format can store. If none of a few matrices has one, as for
/// primitives at the end of the exponent range, uses a matrix that at most mirrors.
template <class S, class Draw>
void place(const Matrices& all, std::vector<Problem>& problems, const Draw& draw) {
    for (Problem& problem : problems) {
        for (int tries = 0; !problem.has_transform; ++tries) {
            Matrix m = tries < 8 ? draw() : Matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
            turn(m, all.orientation);
            const Problem there = transform<S>(problem, m, all.is_inverse);
            if (has_valid_transform<S>(there, all.orientation)) problem = there;
        }
    }
}

template <class Draw>
void place_in(bool floats, const Matrices& all, std::vector<Problem>& problems, const Draw& draw) {
    floats ? place<float>(all, problems, draw) : place<double>(all, problems, draw);
}

}  // namespace

void place_at_random(bool floats, const Matrices& all, Chance& chance, std::vector<Problem>& problems) {
    place_in(floats, all, problems, [&chance] { return random_matrix(chance); });
}

void place_as_made(bool floats, const Matrices& all, Chance& chance, std::vector<Problem>& problems) {
    place_in(floats, all, problems, [&chance] { return made_matrix(chance); });
}

}  // namespace lostbits::exact
