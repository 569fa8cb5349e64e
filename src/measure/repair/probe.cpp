#include "measure/repair/probe.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace lostbits::measure::repair {

using choose::IdealRays;

namespace {

Vec<Real> map_vector(const Vec<Real>& v, const Isometry& isometry) {
    const auto row = [&](std::size_t i) {
        const auto entry = [&](std::size_t k) { return Real(isometry.entries[3 * i + k]); };
        return Real((entry(0) * v.x + entry(1) * v.y + entry(2) * v.z) / Real(isometry.divisor));
    };
    return {row(0), row(1), row(2)};
}

/// Maps the matrix M of a primitive: Q M leads to the world, and M Qᵀ leads from it.
Transform<Real> mirror_transform(Transform<Real> transform, const Isometry& isometry) {
    if (isometry.mirrors()) transform.orientation = -transform.orientation;
    auto& m = transform.matrix;
    for (std::size_t k = 0; k < (transform.is_inverse ? 3U : 4U); ++k) {
        // A column of M, or a row of its linear part.
        const auto entry_index = [&](std::size_t i) { return transform.is_inverse ? 4 * k + i : 4 * i + k; };
        const Vec<Real> v = map_vector({m[entry_index(0)], m[entry_index(1)], m[entry_index(2)]}, isometry);
        for (std::size_t i = 0; i < 3; ++i) m[entry_index(i)] = v[static_cast<int>(i)];
    }
    return transform;
}

bool is_along_axes(Shape shape) {
    return std::ranges::any_of(row_of(shape).keys, [](const Key& key) {
        return key.kind == Key::Kind::lengths || key.limit == Key::Limit::at_least_previous;
    });
}

}  // namespace

std::optional<Primitive<Real>> map_primitive(const Primitive<Real>& primitive, const Isometry& isometry) {
    Primitive<Real> result = primitive;
    if (primitive.transform) {
        result.transform = mirror_transform(*primitive.transform, isometry);
        return result;
    }
    if (!isometry.is_exact() && is_along_axes(primitive.shape)) return std::nullopt;
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.kind == Key::Kind::length) return;
        Vec<Real> v = map_vector(primitive.point(k), isometry);
        for (int i = 0; i < 3 && key.kind == Key::Kind::lengths; ++i) v[i] = abs(v[i]);
        result.set_point(k, v);
        if (key.limit != Key::Limit::at_least_previous) return;
        for (std::size_t i = k; i < k + 3; ++i)
            if (result.numbers[i] < result.numbers[i - 3]) std::swap(result.numbers[i], result.numbers[i - 3]);
    });
    return result;
}

namespace {

constexpr std::size_t max_primitives = 1024, max_pairs = 1 << 17;

std::optional<IdealRays> map_rays(IdealRays ideal, const Isometry& isometry) {
    for (std::size_t i = 0; i < ideal.rays.size(); ++i) {
        const Ray<Real> ray = ideal.rays[i];
        const Vec<Real> o = map_vector(ray.origin, isometry), d = map_vector(ray.direction, isometry);
        ideal.rays.ox[i] = o.x;
        ideal.rays.oy[i] = o.y;
        ideal.rays.oz[i] = o.z;
        ideal.rays.dx[i] = d.x;
        ideal.rays.dy[i] = d.y;
        ideal.rays.dz[i] = d.z;
    }
    for (Primitive<Real>& primitive : ideal.primitives) {
        auto mapped_primitive = map_primitive(primitive, isometry);
        if (!mapped_primitive) return std::nullopt;
        primitive = *std::move(mapped_primitive);
    }
    return ideal;
}

/// Rays of a request before any map, and the format that stores them. Without a format, each form's own format rounds
/// them.
struct RequestRays {
    IdealRays ideal;
    std::optional<FloatFormat> format;
};

std::optional<RequestRays> take_request_rays(const RepairRequest& request, int ray_count) {
    const std::size_t primitive_count = request.scene                    ? request.scene->primitive_count()
                                        : request.rays->sample.is_paired ? 1
                                                                         : request.rays->sample.primitives.size();
    if (primitive_count == 0 || primitive_count > max_primitives) return std::nullopt;
    const std::size_t max_rays =
        std::clamp<std::size_t>(max_pairs / primitive_count, 64, static_cast<std::size_t>(ray_count));
    if (!request.scene) {
        if (request.rays->sample.mesh) return std::nullopt;
        return RequestRays{choose::make_ideal_rays(sample_rays(request.rays->sample, max_rays)),
                           request.rays->format.parameters};
    }
    if (request.scene->flake) return std::nullopt;
    const scene::file::Scene smaller_scene = choose::with_smaller_picture(*request.scene, static_cast<int>(max_rays));
    if (smaller_scene.inputs == scene::file::InputRounding::own)
        return RequestRays{choose::make_ideal_rays(smaller_scene), std::nullopt};
    scene::rays::RayGroup stored_rays{.rays = scene::rays::make_shared_rays(smaller_scene, 0, smaller_scene.height),
                                      .primitives = scene::rays::make_shared_primitives(smaller_scene)};
    return RequestRays{choose::make_ideal_rays(stored_rays), binary32};
}

}  // namespace

std::vector<std::unique_ptr<Probe>> make_probes(const RepairRequest& request, int ray_count) {
    std::vector<std::unique_ptr<Probe>> probes;
    const auto originals = take_request_rays(request, ray_count);
    if (!originals) return probes;
    for (const Isometry& isometry : isometries) {
        if (isometry.mirrors() && request.tested_form.form->info->facing != intersect::Facing::both) continue;
        auto moved_rays = map_rays(originals->ideal, isometry);
        if (!moved_rays) continue;
        if (originals->format)
            probes.push_back(
                std::make_unique<Probe>(isometry, request, store_in_format(*moved_rays, *originals->format)));
        else probes.push_back(std::make_unique<Probe>(isometry, request, *std::move(moved_rays)));
    }
    return probes;
}

namespace {

/// For each input of a tape, the index of the input that takes its place under an exchange of axes.
std::vector<int> exchanged_inputs(const Primitive<double>& example, const Isometry& isometry) {
    std::vector<double> numbers(6 + example.shape_numbers().size() +
                                (example.transform ? example.transform->matrix.size() : 0) + 1);
    std::iota(numbers.begin(), numbers.end(), 0);
    const auto real = [](double x) { return Real(x); };
    const auto vector = [&](const Vec<double>& v) {
        const Vec<Real> mapped = map_vector({Real(v.x), Real(v.y), Real(v.z)}, isometry);
        return Vec<double>(static_cast<double>(mapped.x), static_cast<double>(mapped.y), static_cast<double>(mapped.z));
    };
    const Ray<double> ray = tape::ray_of(numbers);
    const auto primitive = map_primitive(convert_numbers(tape::primitive_of(numbers, example), real), isometry).value();
    const auto exchanged = tape::inputs_of(
        {vector(ray.origin), vector(ray.direction)},
        convert_numbers(primitive, [](const Real& x) { return static_cast<double>(x); }), numbers.back());
    return {exchanged.begin(), exchanged.end()};
}

/// Numbers the expressions of a tape. Two nodes have the same number if they are the same expression, up to the order
/// of operands and the brackets of sums, minima and maxima.
class ValueNumbering {
public:
    explicit ValueNumbering(const Tape& tape) : tape_(tape) {}

    /// Number of each node, with ` inputs` in place of the inputs of the tape.
    std::vector<int> number_expressions(const std::vector<int>& inputs) {
        std::vector<int> ids;
        std::vector<std::vector<int>> terms_of_node;
        for (NodeId i = 0; i < tape_.size(); ++i) {
            const TapeNode& n = tape_[i];
            std::vector<int> terms;
            std::vector<int> key{static_cast<int>(n.op), n.format};
            if (n.op == TapeOp::input) key.push_back(inputs.at(n.operands[0]));
            else if (n.op == TapeOp::constant) key.push_back(n.operands[0]);
            else if (n.op == TapeOp::call) key.insert(key.end(), {i, call_count_++});  // equal to nothing
            else if (n.op == TapeOp::add || n.op == TapeOp::sub || n.op == TapeOp::neg) {
                // A sum is its terms, however they are bracketed.
                key[0] = static_cast<int>(TapeOp::add);
                terms = sum_terms(n, terms_of_node);
                key.insert(key.end(), terms.begin(), terms.end());
            } else {
                add_operands(key, i, ids);
            }

            const int id = ids_.try_emplace(key, static_cast<int>(ids_.size())).first->second;
            if (n.op == TapeOp::min || n.op == TapeOp::max) extremes_[id] = key;
            ids.push_back(id);
            terms_of_node.push_back(terms.empty() ? std::vector<int>{2 * id} : std::move(terms));
        }
        return ids;
    }

private:
    /// Terms of a sum, a difference or a negation, sorted: 2 · the number of the term, + 1 if it is subtracted.
    static std::vector<int> sum_terms(const TapeNode& node, const std::vector<std::vector<int>>& terms_of_node) {
        const auto terms_of_operand = [&](std::size_t k) { return terms_of_node[node.operands[k]]; };
        std::vector<int> terms = terms_of_operand(0);
        if (node.op == TapeOp::neg) negate(terms);
        else {
            auto second_terms = terms_of_operand(1);
            if (node.op == TapeOp::sub) negate(second_terms);
            terms.insert(terms.end(), second_terms.begin(), second_terms.end());
        }
        std::ranges::sort(terms);
        return terms;
    }
    /// Adds the numbers of the operands of node i to its key, in one order if the operation commutes.
    void add_operands(std::vector<int>& key, NodeId i, const std::vector<int>& ids) const {
        const TapeOp op = tape_[i].op;
        for (const NodeId operand : tape_.operands_of(i)) key.push_back(ids[operand]);
        if (op == TapeOp::mul || op == TapeOp::fma || op == TapeOp::logical_and || op == TapeOp::logical_or)
            if (key[2] > key[3]) std::swap(key[2], key[3]);
        if (op == TapeOp::min || op == TapeOp::max) flatten(key);
    }
    static void negate(std::vector<int>& terms) {
        for (int& term : terms) term ^= 1;
    }
    /// Replaces operands that are the same operation (minimum or maximum) by their own operands, and sorts all
    /// operands.
    void flatten(std::vector<int>& key) const {
        std::vector<int> flat_key(key.begin(), key.begin() + 2);
        for (std::size_t k = 2; k < key.size(); ++k) {
            const auto inner = extremes_.find(key[k]);
            if (inner != extremes_.end() && std::equal(key.begin(), key.begin() + 2, inner->second.begin())) {
                flat_key.insert(flat_key.end(), inner->second.begin() + 2, inner->second.end());
            } else flat_key.push_back(key[k]);
        }
        std::sort(flat_key.begin() + 2, flat_key.end());
        key = std::move(flat_key);
    }

    const Tape& tape_;
    std::map<std::vector<int>, int> ids_;
    std::map<int, std::vector<int>> extremes_;  ///< keys of minima and maxima
    int call_count_ = 0;
};

/// Disjoint sets of nodes, which can be merged.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t size) : parents_(size) { std::iota(parents_.begin(), parents_.end(), NodeId(0)); }
    NodeId root_of(NodeId i) {
        NodeId& parent = parents_[i];
        return parent == i ? i : parent = root_of(parent);
    }
    void merge(NodeId a, NodeId b) { parents_[root_of(a)] = root_of(b); }

private:
    std::vector<NodeId> parents_;
};

/// Merges some partial sums into the groups of their whole sums: those that only one sum uses, and that some exchange
/// maps to no operation.
void merge_partial_sums(const Tape& tape, const std::set<NodeId>& incomplete, DisjointSets& groups) {
    std::map<NodeId, std::vector<NodeId>> users;
    for (NodeId i = 0; i < tape.size(); ++i)
        if (!is_given(tape[i].op))
            for (const NodeId operand : tape.operands_of(i)) users[operand].push_back(i);
    const auto is_sum = [&](NodeId i) { return tape[i].op == TapeOp::add || tape[i].op == TapeOp::sub; };
    for (const NodeId i : incomplete)
        if (is_sum(i) && users[i].size() == 1 && is_sum(users[i].front())) groups.merge(i, users[i].front());
}

}  // namespace

std::vector<std::vector<NodeId>> find_exchanged_groups(const Tape& tape, const std::vector<NodeId>& operations,
                                                       const Primitive<double>& example) {
    constexpr Isometry identity{"", "", {1, 0, 0, 0, 1, 0, 0, 0, 1}, 1};
    ValueNumbering expressions(tape);
    const std::vector<int> own_ids = expressions.number_expressions(exchanged_inputs(example, identity));

    // Joins the operations that are one expression.
    std::map<int, NodeId> first_with_id;
    DisjointSets groups(tape.nodes.size());
    for (const NodeId i : operations) {
        const auto [entry, is_new] = first_with_id.try_emplace(own_ids[i], i);
        if (!is_new) groups.merge(i, entry->second);
    }

    // Joins each operation with the one that an exchange of axes turns it into. y z x and the exchange of x and y
    // generate all six exchanges.
    std::set<NodeId> incomplete;
    for (const Isometry* isometry : {&isometries[0], &isometries[2]}) {
        const std::vector<int> exchanged_ids = expressions.number_expressions(exchanged_inputs(example, *isometry));
        for (const NodeId i : operations) {
            const auto entry = first_with_id.find(exchanged_ids[i]);
            if (entry != first_with_id.end()) groups.merge(i, entry->second);
            else incomplete.insert(i);
        }
    }
    merge_partial_sums(tape, incomplete, groups);

    // Lists the groups in the order of their first operations.
    std::map<NodeId, std::vector<NodeId>> members;
    for (const NodeId i : operations) members[groups.root_of(i)].push_back(i);
    std::vector<std::vector<NodeId>> result;
    for (const NodeId i : operations)
        if (const auto entry = members.find(groups.root_of(i)); entry->second.front() == i)
            result.push_back(entry->second);
    return result;
}

}  // namespace lostbits::measure::repair
