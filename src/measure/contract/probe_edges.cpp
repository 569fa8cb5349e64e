// Probes with rays that look for trouble: at rims, seams, apexes and edges behind which a primitive goes on, and at the
// edges and vertices of meshes, at nine scales.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "measure/contract/random_questions.hpp"
#include "measure/crossing/mesh_crossings.hpp"
#include "scene/sweep/distributions.hpp"
#include "shapes/triangle/mesh/made.hpp"

namespace lostbits::measure::contract {
namespace {

namespace rays = scene::rays;
using scene::triangle::Face;
using scene::triangle::Mesh;

/// Powers of two by which all lengths are multiplied, the smallest change first.
constexpr std::array scale_powers{0, -15, 15, -30, 30, -45, 45, -60, 60};

bool is_off_surface(const Primitive<double>& primitive, const Vec<double>& p) {
    return std::fabs(visit(primitive, [&p](const auto& shape) { return shape.distance(p); })) >
           half_extent_of(primitive) / 16;
}

/// Sets each length that may be 0 to 0, so that a cone has an apex.
Primitive<double> shrink_to_apex(Primitive<double> primitive) {
    for_each_key(primitive.shape, [&primitive](const Key& key, std::size_t k) {
        if (key.limit == Key::Limit::not_negative) primitive.numbers[k] = 0;
    });
    return primitive;
}

/// Draws a ray from outside that is aimed at a point, or that misses it by an offset.
Question draw_question_at_point(const rays::AimedPlace& target, double offset, const Primitive<double>& primitive,
                                int bits, RandomNumbers& random) {
    const Vec<double> random_direction = random.unit(), direction = target.along.value_or(random_direction);
    const Vec<double> origin = target.point + offset * random.unit() - 4 * half_extent_of(primitive) * direction;
    Question q = make_question(origin, direction, primitive);
    if (bits == 64) q.ray = {origin, direction};  // nearer to the place than floats are
    return q;
}

/// Returns rays at one kind of place of random primitives, such as a rim. Half of the rays are aimed at the place
/// itself, the others miss it by up to 2^-10 of the size of the primitive. All rays are benign. A ray that misses
/// counts only if the place is not on the surface: a ray that touches an edge from outside would pass for benign,
/// because few rays near it hit.
std::vector<AnsweredQuestion> make_questions_at_place(const Trial& trial,
                                                      const scene::sweep::DistributionRow& distribution, int aim,
                                                      bool is_upright) {
    constexpr int attempt_count = 320, changes = 32;
    constexpr std::size_t max_questions = 64;
    RandomNumbers random;
    rays::Random place_random(1);
    std::vector<Question> questions;
    for (int i = 0; i < attempt_count && questions.size() < max_questions; ++i) {
        const Primitive<double> any_primitive = draw_primitive(trial.shape, is_upright, random);
        const Primitive<double> primitive = i % 4 < 2 ? any_primitive : shrink_to_apex(any_primitive);

        const rays::AimedPlace target = distribution.draw_target(place_random, primitive, aim);
        const double offset = i % 2 == 0 ? 0 : half_extent_of(primitive) * std::ldexp(1, -10 - i % 16);
        const Question q = draw_question_at_point(target, offset, primitive, trial.contract.bits, random);

        if ((trial.truth(q).hit || is_off_surface(primitive, target.point)) && is_benign(trial, q, random, changes))
            questions.push_back(q);
    }
    return add_truths(trial, questions);
}

/// Rays at all places of a shape, by the name of the place.
using Places = std::vector<std::pair<std::string_view, std::vector<AnsweredQuestion>>>;

Places make_questions_at_places(const Trial& trial, const scene::sweep::DistributionRow& distribution,
                                bool is_upright) {
    Places places;
    for (const auto& [name, aim] : distribution.aims)
        places.emplace_back(name, make_questions_at_place(trial, distribution, aim, is_upright));
    return places;
}

WrongCount count_wrong_at_scale(const Trial& trial, const Places& places, int power) {
    WrongCount total;
    for (const auto& [name, answered] : places) {
        WrongCount count(trial, answered, power);
        if (!count.first_text.empty()) count.first_text = fmt::format("aimed at its {}, {}", name, count.first_text);
        total.add(count);
    }
    return total;
}

/// For example "383 of 2200 (17 %)".
std::string count_and_percent(std::size_t part, std::size_t whole) {
    const double percent = 100.0 * static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
    return fmt::format("{} of {} ({:.3g} %)", part, whole, percent);
}

std::string power_text(int power) { return "2^" + std::to_string(power); }

/// Text about the first scale at which far more answers are wrong than at 2^0.
std::string scale_text(int power, std::size_t wrong, std::size_t tested) {
    return fmt::format(
        "; the first of nine scales that fails is {}, where {} of {} are answered wrongly: it compares with a fixed "
        "number, or its products leave the range of the format",
        power_text(power), wrong, tested);
}
/// Reports that all answers are right: at all scales, or up to the scale in `scale_limit`, which `scale_text` wrote.
void report_right(Trial& trial, const std::string& text, const std::string& scale_limit) {
    if (scale_limit.empty()) trial.report_kept(text + ", at nine scales from 2^-60 to 2^60");
    else trial.report_note(text + scale_limit);
}

/// Tests rays at all places of random primitives. Axes along x, y and z come first: a form may support no others.
void try_places(Trial& trial, const scene::sweep::DistributionRow& distribution) {
    std::size_t tested = 0;
    std::string names, scale_limit;
    for (const auto& [name, aim] : distribution.aims) names += (names.empty() ? "" : ", ") + std::string(name);
    for (const bool is_upright : {true, false}) {
        if (is_upright && !has_axis(trial.shape)) continue;
        const Places places = make_questions_at_places(trial, distribution, is_upright);
        const WrongCount unscaled = count_wrong_at_scale(trial, places, 0);
        tested += unscaled.tested_count;

        // Any wrong answer ends the probe. It is a warning if few are wrong, or if upright primitives are right.
        if (unscaled.wrong_count > 0) {
            const bool is_oblique = !is_upright && has_axis(trial.shape);
            const std::string text = fmt::format(
                "{} of {} rays are answered wrongly that cross the surface near a place where its parts meet; the "
                "first is {}{}",
                unscaled.wrong_count, unscaled.tested_count, unscaled.first_text,
                is_oblique ? "; where axes lie along x, y or z it is right" : "");
            return unscaled.is_many() && !is_oblique ? trial.report_broken(text) : trial.report_warning(text);
        }

        // Finds the first scale at which many answers are wrong.
        for (const int power : scale_powers)
            if (const WrongCount count = count_wrong_at_scale(trial, places, power);
                count.is_many() && scale_limit.empty())
                scale_limit = scale_text(power, count.wrong_count, count.tested_count);
    }

    report_right(
        trial,
        fmt::format("{} rays at places of {} ({}) get the right answer", tested, row_of(trial.shape).plural, names),
        scale_limit);
}

Vec<double> round_to_bits(const Vec<double>& v, int bits) { return bits == 32 ? rays::stored(v) : v; }

/// A closed convex mesh: an icosphere, stretched and turned at random, in numbers of the format.
Mesh make_random_mesh(int bits, rays::Random& random) {
    Mesh mesh = scene::triangle::make_icosphere(1, {0, 0, 0}, 1);
    const Vec<double> x = random.between(0.5, 2) * rays::draw_direction(random);
    const Vec<double> y = random.between(0.5, 2) * rays::draw_perpendicular(random, x);
    const Vec<double> z = cross((1 / length(x)) * x, y);
    for (Vec<double>& v : mesh.vertices) v = round_to_bits(v.x * x + v.y * y + v.z * z, bits);
    merge_and_count(mesh, [](std::size_t) { return std::string(); });
    return mesh;
}

/// A ray that meets a closed mesh near an edge or a vertex, and the triangles around it.
struct RayAtMeshEdge {
    Ray<double> ray{};
    bool at_vertex = false;
    double distance = 0;  ///< from the origin to the edge or vertex, in lengths of the edge
    /// Triangles that share a vertex with the edge; those at the edge or the vertex come first.
    std::vector<Primitive<double>> adjacent = {};
    std::vector<Primitive<double>> others = {};  ///< all other triangles that face the ray
};

/// Moves a number by up to two ulps of the format, at random.
double move_by_ulps(double x, int bits, rays::Random& random) {
    for (int k = random.below(3); k > 0; --k) {
        const double limit = random.sign() * std::numeric_limits<float>::max();
        x = bits == 32 ? std::nextafter(static_cast<float>(x), static_cast<float>(limit)) : std::nextafter(x, limit);
    }
    return x;
}

/// The two vertices of an edge of a mesh.
using EdgeEnds = std::array<std::uint32_t, 2>;

EdgeEnds draw_edge(const Mesh& mesh, rays::Random& random) {
    const Face& face = mesh.faces[random.below(static_cast<int>(mesh.faces.size()))];
    const auto k = static_cast<std::size_t>(random.below(3));
    return {face[k], face[(k + 1) % 3]};
}

/// Draws a ray from outside that is aimed at an edge, or at its first vertex if `edge_ray` is at a vertex. Its numbers
/// are those of the format, and may be some ulps beside the aim. Writes the ray and its distance to `edge_ray`.
void aim_at_edge(const EdgeEnds& ends, const Mesh& mesh, const intersect::external::Contract& contract,
                 rays::Random& random, RayAtMeshEdge& edge_ray) {
    // The direction goes towards the middle of the mesh, which is around the origin.
    const Vec<double> a = mesh.vertices[ends[0]], b = mesh.vertices[ends[1]];
    const Vec<double> target = edge_ray.at_vertex ? a : a + random.unit() * (b - a),
                      random_direction = rays::draw_direction(random);
    const Vec<double> d = dot(random_direction, target) < 0 ? random_direction : -1.0 * random_direction;

    const int octave = random.below(30);
    edge_ray.distance = std::ldexp(1 + random.unit(), octave - 10);
    const Vec<double> origin = round_to_bits(target - (edge_ray.distance * length(b - a)) * d, contract.bits),
                      to_target = target - origin;

    Vec<double> direction = round_to_bits((1 / length(to_target)) * to_target, contract.bits);
    if (contract.direction == intersect::Direction::any && random.below(4) != 0)
        for (int i = 0; i < 3; ++i) direction[i] = move_by_ulps(direction[i], contract.bits, random);
    edge_ray.ray = {origin, direction};
}

/// Sorts the triangles of the mesh into those at the edge or around it, and all others that face the ray. Returns false
/// if the ray meets no triangle at its edge or vertex, or meets one of them at a grazing angle or from behind.
bool collect_triangles(const EdgeEnds& ends, const Mesh& mesh, RayAtMeshEdge& edge_ray) {
    bool is_met = false;
    for (const Face& f : mesh.faces) {
        const auto has_vertex = [&](std::uint32_t v) { return std::ranges::count(f, v) != 0; };
        const bool is_adjacent = has_vertex(ends[0]) && (edge_ray.at_vertex || has_vertex(ends[1]));
        const auto triangle = scene::triangle::corners_of(f, mesh.vertices);
        const Vec<double> n = cross(triangle.b - triangle.a, triangle.c - triangle.a);

        if (!has_vertex(ends[0]) && (edge_ray.at_vertex || !has_vertex(ends[1]))) {
            if (dot(n, edge_ray.ray.direction) < 0) edge_ray.others.emplace_back(triangle);
            continue;
        }
        if (is_adjacent && !(-dot(n, edge_ray.ray.direction) > 0.125 * length(n))) return false;
        if (is_adjacent) is_met = is_met || truth::find_truth(edge_ray.ray, Primitive<double>(triangle)).is_hit();
        edge_ray.adjacent.insert(is_adjacent ? edge_ray.adjacent.begin() : edge_ray.adjacent.end(), triangle);
    }
    return is_met;
}

/// Draws a ray from 2^-10 to 2^20 lengths of an edge away. It meets all triangles at the edge or the vertex from the
/// front, at an angle of 7° or more, so that no light should pass. Empty if the rounded ray does not.
std::optional<RayAtMeshEdge> draw_ray(const Mesh& mesh, const intersect::external::Contract& contract,
                                      rays::Random& random) {
    const EdgeEnds ends = draw_edge(mesh, random);
    RayAtMeshEdge edge_ray;
    edge_ray.at_vertex = random.below(3) == 0;
    aim_at_edge(ends, mesh, contract, random, edge_ray);
    return collect_triangles(ends, mesh, edge_ray) ? std::optional(edge_ray) : std::nullopt;
}

Question question_at(const Ray<double>& ray, const Primitive<double>& primitive) {
    Question q{.ray = ray, .primitive = {}};
    std::ranges::copy(primitive.shape_numbers(), q.primitive.begin());
    return q;
}

/// Counts of rays that were tested, and of those that pass between the triangles.
struct PassingCounts {
    std::size_t tested = 0, passed = 0;

    void add(const PassingCounts& other) {
        tested += other.tested;
        passed += other.passed;
    }
    [[nodiscard]] std::string text() const { return count_and_percent(passed, tested); }
};

/// Counts of rays at edges and vertices of meshes, and a description of the first ray that passes.
struct EdgeRayCounts {
    PassingCounts at_edges, at_vertices;
    std::string first_text;

    void add(const EdgeRayCounts& other) {
        at_edges.add(other.at_edges);
        at_vertices.add(other.at_vertices);
        if (first_text.empty()) first_text = other.first_text;
    }
    [[nodiscard]] std::size_t all_tested() const { return at_edges.tested + at_vertices.tested; }
    [[nodiscard]] std::size_t all_passed() const { return at_edges.passed + at_vertices.passed; }
};

/// Returns a question for the ray and each of the triangles, with all lengths multiplied by 2^power.
std::vector<Question> questions_at(const Trial& trial, const Ray<double>& ray,
                                   const std::vector<Primitive<double>>& triangles, int power) {
    std::vector<Question> questions;
    for (Primitive<double> primitive : triangles) {
        // Forms for one side see the mesh from inside: `ask` mirrors questions for forms that only see fronts.
        if (trial.contract.facing != intersect::Facing::both)
            std::swap_ranges(primitive.numbers.begin(), primitive.numbers.begin() + 3, primitive.numbers.begin() + 3);
        questions.push_back(scale_question(question_at(ray, primitive), trial.shape, power));
    }
    return questions;
}

bool any_hit(const Trial& trial, std::span<const Question> questions, std::span<const Reply> replies) {
    for (std::size_t k = 0; k < questions.size(); ++k)
        if (read_reply(trial.contract, replies[k], questions[k]).hit) return true;
    return false;
}

/// Draws the rays of a scale, at edges and vertices of random meshes.
std::vector<RayAtMeshEdge> draw_rays(const Trial& trial, std::size_t scale) {
    constexpr int attempt_count = 768, rays_of_mesh = 16;
    rays::Random random(scale + 1);
    std::vector<RayAtMeshEdge> rays_at_edges;
    Mesh mesh;
    for (int i = 0; i < attempt_count; ++i) {
        if (i % rays_of_mesh == 0) mesh = make_random_mesh(trial.contract.bits, random);
        if (const auto edge_ray = draw_ray(mesh, trial.contract, random)) rays_at_edges.push_back(*edge_ray);
    }
    return rays_at_edges;
}

/// Text about a ray at an edge or vertex. `adjacent` are the questions about the triangles around it.
std::string edge_ray_text(const RayAtMeshEdge& edge_ray, std::span<const Question> adjacent) {
    return fmt::format("ray {} at {} of triangles {} and {}, {:.3g} edge lengths away", numbers_text(adjacent[0].ray),
                       edge_ray.at_vertex ? "a vertex" : "the edge",
                       numbers_text(std::span(adjacent[0].primitive).first(9)),
                       numbers_text(std::span(adjacent[1].primitive).first(9)), edge_ray.distance);
}

/// Counts the rays of a scale that pass: light passes if the form claims no triangle that faces the ray. The triangles
/// around the edge or vertex are tested in one batch. The other triangles are tested only if the form claims none of
/// these. Each scale has rays of its own.
EdgeRayCounts count_passing_rays(const Trial& trial, std::size_t scale) {
    const std::vector<RayAtMeshEdge> rays_at_edges = draw_rays(trial, scale);
    std::vector<Question> questions;
    for (const RayAtMeshEdge& edge_ray : rays_at_edges) {
        const auto adjacent = questions_at(trial, edge_ray.ray, edge_ray.adjacent, scale_powers[scale]);
        questions.insert(questions.end(), adjacent.begin(), adjacent.end());
    }
    const std::vector<Reply> replies = ask(trial.form, questions);

    EdgeRayCounts counts;
    std::size_t first = 0;
    for (const RayAtMeshEdge& edge_ray : rays_at_edges) {
        const auto adjacent = std::span(questions).subspan(first, edge_ray.adjacent.size());
        bool is_hit = any_hit(trial, adjacent, std::span(replies).subspan(first, edge_ray.adjacent.size()));
        first += edge_ray.adjacent.size();

        if (!is_hit) {
            const auto further_questions = questions_at(trial, edge_ray.ray, edge_ray.others, scale_powers[scale]);
            is_hit = any_hit(trial, further_questions, ask(trial.form, further_questions));
        }

        (edge_ray.at_vertex ? counts.at_vertices : counts.at_edges)
            .add({.tested = 1, .passed = is_hit ? std::size_t{0} : std::size_t{1}});
        if (!is_hit && counts.first_text.empty()) counts.first_text = edge_ray_text(edge_ray, adjacent);
    }
    return counts;
}

void try_mesh(Trial& trial) {
    const EdgeRayCounts unscaled = count_passing_rays(trial, 0);
    EdgeRayCounts total = unscaled;
    std::string scale_limit;
    for (std::size_t scale = 1; scale < scale_powers.size(); ++scale) {
        const EdgeRayCounts counts = count_passing_rays(trial, scale);
        // A scale fails if far more rays pass there than at 2^0.
        if (20 * counts.all_passed() > counts.all_tested() + 60 * unscaled.all_passed()) {
            scale_limit = scale_text(scale_powers[scale], counts.all_passed(), counts.all_tested());
            break;
        }
        total.add(counts);
    }

    if (total.all_passed() > 0)
        return trial.report_warning(fmt::format(
            "{} rays at edges and {} at vertices of closed meshes pass between the triangles: it claims none of them; "
            "the first is {}{}",
            total.at_edges.text(), total.at_vertices.text(), total.first_text, scale_limit));
    report_right(trial,
                 fmt::format("no ray passes between triangles, of {} at edges and {} at vertices of closed meshes",
                             total.at_edges.tested, total.at_vertices.tested),
                 scale_limit);
}

}  // namespace

void try_edges(Trial& trial) {
    if (trial.shape == Mesh::shape) return try_mesh(trial);
    const auto distribution =
        std::ranges::find(scene::sweep::distributions(), trial.shape, &scene::sweep::DistributionRow::shape);
    if (distribution != scene::sweep::distributions().end() && !distribution->aims.empty())
        try_places(trial, *distribution);
}

}  // namespace lostbits::measure::contract
