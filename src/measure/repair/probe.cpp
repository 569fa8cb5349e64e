#include "measure/repair/probe.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace lostbits::measure::repair {

using choice::IdealRays;

namespace {

Vec<Real> mapped_vector(const Vec<Real>& v, const Isometry& by) {
    const auto row = [&](std::size_t i) {
        const auto entry = [&](std::size_t k) { return Real(by.entries[3 * i + k]); };
        return Real((entry(0) * v.x + entry(1) * v.y + entry(2) * v.z) / Real(by.divisor));
    };
    return {row(0), row(1), row(2)};
}

/// Maps the matrix M of a primitive: Q M leads to the world, and M Qᵀ leads from it.
Placement<Real> mapped_placement(Placement<Real> placed, const Isometry& by) {
    if (by.mirrors()) placed.orientation = -placed.orientation;
    auto& m = placed.matrix;
    for (std::size_t k = 0; k < (placed.is_inverse ? 3U : 4U); ++k) {
        // A column of M, or a row of its linear part.
        const auto at = [&](std::size_t i) { return placed.is_inverse ? 4 * k + i : 4 * i + k; };
        const Vec<Real> v = mapped_vector({m[at(0)], m[at(1)], m[at(2)]}, by);
        m[at(0)] = v.x, m[at(1)] = v.y, m[at(2)] = v.z;
    }
    return placed;
}

bool is_along_axes(Shape shape) {
    return std::ranges::any_of(row_of(shape).keys, [](const Key& key) {
        return key.kind == Key::Kind::lengths || key.limit == Key::Limit::at_least_before;
    });
}

}  // namespace

std::optional<Primitive<Real>> mapped(const Primitive<Real>& primitive, const Isometry& by) {
    Primitive<Real> to = primitive;
    if (primitive.placed) {
        to.placed = mapped_placement(*primitive.placed, by);
        return to;
    }
    if (!by.is_exact() && is_along_axes(primitive.shape)) return std::nullopt;
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::length) return;
        Vec<Real> v = mapped_vector(primitive.point(k), by);
        for (int i = 0; i < 3 && key.kind == Key::Kind::lengths; ++i) v[i] = abs(v[i]);
        to.set_point(k, v);
        if (key.limit != Key::Limit::at_least_before) return;
        for (std::size_t i = k; i < k + 3; ++i)
            if (to.numbers[i] < to.numbers[i - 3]) std::swap(to.numbers[i], to.numbers[i - 3]);
    });
    return to;
}

namespace {

constexpr std::size_t most_probed = 1024, most_pairs = 1 << 17;

std::optional<IdealRays> mapped_rays(IdealRays ideal, const Isometry& by) {
    for (std::size_t i = 0; i < ideal.rays.size(); ++i) {
        const Ray<Real> ray = ideal.rays[i];
        const Vec<Real> o = mapped_vector(ray.origin, by), d = mapped_vector(ray.direction, by);
        ideal.rays.ox[i] = o.x, ideal.rays.oy[i] = o.y, ideal.rays.oz[i] = o.z;
        ideal.rays.dx[i] = d.x, ideal.rays.dy[i] = d.y, ideal.rays.dz[i] = d.z;
    }
    for (Primitive<Real>& primitive : ideal.primitives) {
        auto to = mapped(primitive, by);
        if (!to) return std::nullopt;
        primitive = *std::move(to);
    }
    return ideal;
}

/// The rays of a request as they are given, and the format that stores them; without one they are rounded by whom they
/// are given to.
struct GivenRays {
    IdealRays ideal;
    std::optional<FloatFormat> format;
};

std::optional<GivenRays> given_rays(const RepairRequest& request, int rays) {
    const std::size_t primitives = request.scene                 ? request.scene->primitive_count()
                                   : request.rays->sample.paired ? 1
                                                                 : request.rays->sample.primitives.size();
    if (primitives == 0 || primitives > most_probed) return std::nullopt;
    const std::size_t most = std::clamp<std::size_t>(most_pairs / primitives, 64, static_cast<std::size_t>(rays));
    if (!request.scene) {
        if (request.rays->sample.mesh) return std::nullopt;
        return GivenRays{choice::ideal_of(some_of(request.rays->sample, most)), request.rays->format.parameters};
    }
    if (request.scene->flake) return std::nullopt;
    const scene::file::Scene thin = choice::with_smaller_picture(*request.scene, static_cast<int>(most));
    if (thin.inputs == scene::file::Inputs::own) return GivenRays{choice::ideal_of(thin), std::nullopt};
    scene::rays::RayGroup stored{.rays = scene::rays::make_shared_rays(thin, 0, thin.height),
                                 .primitives = scene::rays::shared_primitives(thin)};
    return GivenRays{choice::ideal_of(stored), binary32};
}

}  // namespace

std::vector<std::unique_ptr<Probe>> probes_of(const RepairRequest& request, int rays) {
    std::vector<std::unique_ptr<Probe>> probes;
    const auto given = given_rays(request, rays);
    if (!given) return probes;
    for (const Isometry& by : isometries) {
        if (by.mirrors() && request.row.form->info->facing != intersect::Facing::both) continue;
        auto moved = mapped_rays(given->ideal, by);
        if (!moved) continue;
        if (given->format) probes.push_back(std::make_unique<Probe>(by, request, stored(*moved, *given->format)));
        else probes.push_back(std::make_unique<Probe>(by, request, *std::move(moved)));
    }
    return probes;
}

namespace {

/// For each input of a tape, the input that takes its place under an exchange of axes.
std::vector<int> exchanged_inputs(const Primitive<double>& like, const Isometry& by) {
    std::vector<double> numbers(6 + like.used().size() + (like.placed ? like.placed->matrix.size() : 0) + 1);
    std::iota(numbers.begin(), numbers.end(), 0);
    const auto real = [](double x) { return Real(x); };
    const auto vector = [&](const Vec<double>& v) {
        const Vec<Real> to = mapped_vector({Real(v.x), Real(v.y), Real(v.z)}, by);
        return Vec<double>(static_cast<double>(to.x), static_cast<double>(to.y), static_cast<double>(to.z));
    };
    const Ray<double> ray = tape::ray_of(numbers);
    const auto primitive = mapped(transformed(tape::primitive_of(numbers, like), real), by).value();
    const auto there =
        tape::inputs_of({vector(ray.origin), vector(ray.direction)},
                        transformed(primitive, [](const Real& x) { return static_cast<double>(x); }), numbers.back());
    return {there.begin(), there.end()};
}

/// Expressions as numbers: two nodes have the same number if they are the same expression, up to the order of operands
/// and the brackets of sums, minima and maxima.
class ValueNumbering {
public:
    explicit ValueNumbering(const Tape& tape) : tape_(tape) {}

    /// The number of each node, with other inputs in place of its own.
    std::vector<int> numbers_with(const std::vector<int>& inputs) {
        std::vector<int> ids;
        std::vector<std::vector<int>> parts;  // terms of a sum, twice their number, plus one if subtracted
        for (NodeId i = 0; i < tape_.size(); ++i) {
            const TapeNode& n = tape_[i];
            const auto part = [&](std::size_t k) { return parts[static_cast<std::size_t>(n.operands[k])]; };
            std::vector<int> all;
            std::vector<int> key{static_cast<int>(n.op), n.format};
            if (n.op == TapeOp::input) key.push_back(inputs.at(static_cast<std::size_t>(n.operands[0])));
            else if (n.op == TapeOp::constant) key.push_back(n.operands[0]);
            else if (n.op == TapeOp::call) key.insert(key.end(), {i, serial_++});  // equal to nothing
            else if (n.op == TapeOp::add || n.op == TapeOp::sub || n.op == TapeOp::neg) {
                key[0] = static_cast<int>(TapeOp::add);
                all = part(0);
                if (n.op == TapeOp::neg) negate(all);
                else {
                    auto second = part(1);
                    if (n.op == TapeOp::sub) negate(second);
                    all.insert(all.end(), second.begin(), second.end());
                }
                std::ranges::sort(all);
                key.insert(key.end(), all.begin(), all.end());
            } else {
                for (const NodeId operand : tape_.operands_of(i)) key.push_back(ids[static_cast<std::size_t>(operand)]);
                if (n.op == TapeOp::mul || n.op == TapeOp::fma || n.op == TapeOp::both || n.op == TapeOp::either)
                    if (key[2] > key[3]) std::swap(key[2], key[3]);
                if (n.op == TapeOp::min || n.op == TapeOp::max) flatten(key);
            }
            const int id = known_.try_emplace(key, static_cast<int>(known_.size())).first->second;
            if (n.op == TapeOp::min || n.op == TapeOp::max) extremes_[id] = key;
            ids.push_back(id);
            parts.push_back(all.empty() ? std::vector<int>{2 * id} : std::move(all));
        }
        return ids;
    }

private:
    static void negate(std::vector<int>& terms) {
        for (int& term : terms) term ^= 1;
    }
    /// Replaces operands that are the same choice by their operands, and sorts all.
    void flatten(std::vector<int>& key) const {
        std::vector<int> all(key.begin(), key.begin() + 2);
        for (std::size_t k = 2; k < key.size(); ++k) {
            const auto inner = extremes_.find(key[k]);
            if (inner != extremes_.end() && std::equal(key.begin(), key.begin() + 2, inner->second.begin())) {
                all.insert(all.end(), inner->second.begin() + 2, inner->second.end());
            } else all.push_back(key[k]);
        }
        std::sort(all.begin() + 2, all.end());
        key = std::move(all);
    }

    const Tape& tape_;
    std::map<std::vector<int>, int> known_;
    std::map<int, std::vector<int>> extremes_;  ///< keys of minima and maxima
    int serial_ = 0;
};

/// Sets that are joined.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t n) : of_(n) { std::iota(of_.begin(), of_.end(), NodeId(0)); }
    NodeId of(NodeId i) {
        NodeId& up = of_[static_cast<std::size_t>(i)];
        return up == i ? i : up = of(up);
    }
    void join(NodeId a, NodeId b) { of_[static_cast<std::size_t>(of(a))] = of(b); }

private:
    std::vector<NodeId> of_;
};

/// Joins each partial sum that is used by one sum alone, and that some exchange maps to no operation, with that sum.
void join_partial_sums(const Tape& tape, const std::set<NodeId>& incomplete, DisjointSets& groups) {
    std::map<NodeId, std::vector<NodeId>> users;
    for (NodeId i = 0; i < tape.size(); ++i)
        if (!is_given(tape[i].op))
            for (const NodeId operand : tape.operands_of(i)) users[operand].push_back(i);
    const auto is_sum = [&](NodeId i) { return tape[i].op == TapeOp::add || tape[i].op == TapeOp::sub; };
    for (const NodeId i : incomplete)
        if (is_sum(i) && users[i].size() == 1 && is_sum(users[i].front())) groups.join(i, users[i].front());
}

}  // namespace

std::vector<std::vector<NodeId>> exchanged_groups(const Tape& tape, const std::vector<NodeId>& operations,
                                                  const Primitive<double>& like) {
    constexpr Isometry same{"", "", {1, 0, 0, 0, 1, 0, 0, 0, 1}, 1};
    ValueNumbering expressions(tape);
    const std::vector<int> own = expressions.numbers_with(exchanged_inputs(like, same));
    std::map<int, NodeId> first;
    DisjointSets groups(tape.nodes.size());
    for (const NodeId i : operations) {
        const auto [at, is_new] = first.try_emplace(own[static_cast<std::size_t>(i)], i);
        if (!is_new) groups.join(i, at->second);
    }
    // y z x and the exchange of x and y generate all six exchanges.
    std::set<NodeId> incomplete;
    for (const Isometry* by : {&isometries[0], &isometries[2]}) {
        const std::vector<int> there = expressions.numbers_with(exchanged_inputs(like, *by));
        for (const NodeId i : operations) {
            const auto at = first.find(there[static_cast<std::size_t>(i)]);
            if (at != first.end()) groups.join(i, at->second);
            else incomplete.insert(i);
        }
    }
    join_partial_sums(tape, incomplete, groups);
    std::map<NodeId, std::vector<NodeId>> members;
    for (const NodeId i : operations) members[groups.of(i)].push_back(i);
    std::vector<std::vector<NodeId>> all;
    for (const NodeId i : operations)
        if (const auto at = members.find(groups.of(i)); at->second.front() == i) all.push_back(at->second);
    return all;
}

}  // namespace lostbits::measure::repair
