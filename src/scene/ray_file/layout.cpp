#include "scene/ray_file/layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "shapes/number_names.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::scene::ray_file {

namespace {

/// A name by which files may call a number. Messages use the first name of a slot.
struct KnownName {
    std::string name;
    std::size_t slot;
    std::optional<Shape> shape = {};
};

std::vector<KnownName> make_known_names() {
    std::vector<KnownName> known;
    const auto add = [&known](std::size_t slot, std::initializer_list<const char*> names) {
        for (const char* const name : names) known.push_back({name, slot++});
    };

    add(slot::origin, {"ox", "oy", "oz", "dx", "dy", "dz", "tmax", "tmin"});
    for (const ShapeRow& shape_row : shape_rows)
        for (std::size_t k = 0; k < shape_row.number_count; ++k)
            known.push_back({column_names(shape_row.shape)[k], slot::primitive + k, shape_row.shape});

    add(slot::t, {"t"});
    add(slot::hit, {"hit"});
    add(slot::object, {"object"});
    add(slot::hit_index, {"hit_index", "crossings", "parity", "inside"});
    for (std::size_t k = 0; k < matrix_columns.size(); ++k)
        known.push_back({std::string(matrix_columns[k]), slot::matrix + k});

    // Names in the project's own tables and in other programs.
    add(slot::origin, {"px", "py", "pz"});
    add(slot::origin,
        {"origin_x", "origin_y", "origin_z", "direction_x", "direction_y", "direction_z", "t_max", "t_min"});
    for (const ShapeRow& shape_row : shape_rows)
        for (std::size_t k = 0; k < shape_row.number_count; ++k)
            for (std::string& name : other_column_names(shape_row.shape, k))
                known.push_back({std::move(name), slot::primitive + k, shape_row.shape});
    return known;
}

const std::vector<KnownName>& known_names() {
    static const std::vector<KnownName> all = make_known_names();
    return all;
}

std::string to_lower_case(std::string_view name) {
    std::string lower;
    for (const char c : name) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return lower;
}

/// Finds a known name; null if no such name is known. If several shapes have the name, `shape` is preferred.
const KnownName* find_known_name(std::string_view name, std::optional<Shape> shape) {
    const auto has_name_for_shape = [&](const KnownName& known) {
        return known.name == name && (!known.shape || known.shape == shape);
    };
    auto found = std::ranges::find_if(known_names(), has_name_for_shape);
    if (found == known_names().end()) found = std::ranges::find(known_names(), name, &KnownName::name);
    return found == known_names().end() ? nullptr : &*found;
}

/// The numbers of a shape that columns name.
struct NamedNumbers {
    Shape shape;
    std::set<std::size_t> slots = {};

    /// True if no required number is missing.
    [[nodiscard]] bool are_complete() const {
        bool is_complete = true;
        for (std::size_t k = 0; k < row_of(shape).number_count; ++k)
            is_complete = is_complete && (slots.contains(slot::primitive + k) || is_optional(shape, k));
        return is_complete;
    }
};

/// The shapes that a file names, and the chosen shape. Candidates are the shapes that have a column for each number or,
/// if there is no such shape, all shapes. The candidate with the most columns is chosen, or the first of several with
/// equally many. (Hits in a file of spheres may have normals, which discs have too.)
struct NamedShapes {
    std::vector<NamedNumbers> all;  ///< in the order of the list
    std::optional<Shape> chosen;

    explicit NamedShapes(const std::vector<std::string>& names) {
        for (const ShapeRow& shape_row : shape_rows) all.push_back({shape_row.shape});
        for (const KnownName& known : known_names())
            if (known.shape && std::ranges::find(names, known.name) != names.end())
                all[static_cast<std::size_t>(*known.shape)].slots.insert(known.slot);
        const auto best_match = std::ranges::max_element(
            all, {}, [](const NamedNumbers& n) { return std::pair(n.are_complete(), n.slots.size()); });
        if (!best_match->slots.empty()) chosen = best_match->shape;
    }
    /// True if a number of the shape `other` is only a column of the user's own: the chosen shape is complete, and
    /// `other` is not.
    [[nodiscard]] bool is_users_own(Shape other) const {
        return other != chosen && all[static_cast<std::size_t>(*chosen)].are_complete() &&
               !all[static_cast<std::size_t>(other)].are_complete();
    }
};

constexpr std::string_view hex_suffix = "_hex";

/// Names of at most six columns, as in the file.
std::string column_list(const std::vector<LayoutColumn>& columns) {
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(columns.size(), 6); ++i)
        names += (i == 0 ? "" : ",") + columns[i].name;
    return columns.size() > 6 ? names + ",..." : names;
}

/// Meaning of the name of a column.
struct ColumnMatch {
    const KnownName* known = nullptr;  ///< null for a column of the user's own
    bool is_hex = false;
};

/// True if a column has a known name whose slot is in [first, last).
bool has_any_slot(const std::vector<ColumnMatch>& matches, std::size_t first, std::size_t last) {
    return std::ranges::any_of(
        matches, [&](const ColumnMatch& f) { return f.known && f.known->slot >= first && f.known->slot < last; });
}

/// Ignores names that mean something only in files of another kind. Files of rays and of first hits may have columns of
/// their own with these names.
void ignore_foreign_names(const std::vector<std::string>& names, bool has_hit_columns, bool has_directions,
                          std::vector<ColumnMatch>& matches) {
    const bool has_points = !has_directions && has_any_slot(matches, slot::inside, slot::matrix);
    for (std::size_t c = 0; c < matches.size(); ++c) {
        if (matches[c].known == nullptr) continue;
        const std::size_t s = matches[c].known->slot;
        if ((has_hit_columns && (s == slot::crossings || s == slot::parity)) || (has_directions && s == slot::inside) ||
            (!has_points && s < slot::direction && names[c].starts_with('p')))
            matches[c].known = nullptr;
    }
}

}  // namespace

std::string_view name_of_slot(std::size_t slot, std::optional<Shape> shape) {
    const auto has_slot = [&](const KnownName& known) {
        return known.slot == slot && (!known.shape || !shape || *known.shape == *shape);
    };
    return std::ranges::find_if(known_names(), has_slot)->name;
}

Layout::Layout(std::vector<std::string> names, const Complain& complain) {
    for (std::string& name : names) columns_.push_back({std::move(name), {}, false});
    find_slots(complain);
    require_complete(complain);
}

void Layout::give_slot(std::size_t c, std::size_t slot, std::optional<Shape> shape, const Complain& complain) {
    if (shape && primitive_shape_ && *shape != *primitive_shape_)
        complain(c, fmt::format("\"{}\" is a number of {}, but other columns are of {}; a file has primitives of one "
                                "shape; leave one of the two out",
                                columns_[c].name, with_article(*shape), with_article(*primitive_shape_)));
    if (column_of_slot_[slot])
        complain(c, fmt::format("\"{}\" has the same meaning as column \"{}\"; rename one of the two", columns_[c].name,
                                columns_[*column_of_slot_[slot]].name));
    if (shape) primitive_shape_ = shape;
    column_of_slot_[slot] = c;
    columns_[c].slot = slot;
}

void Layout::find_slots(const Complain& complain) {
    // Compares names without regard to case and to the suffix of hexadecimal columns.
    std::vector<ColumnMatch> matches(columns_.size());
    std::vector<std::string> names;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        std::string& name = names.emplace_back(to_lower_case(columns_[c].name));
        columns_[c].is_skipped = name == "_";
        matches[c].is_hex = name.ends_with(hex_suffix);
        if (matches[c].is_hex) name.erase(name.size() - hex_suffix.size());
    }

    // Finds the known name of each column, unless it is a number of a shape that the file does not have.
    const NamedShapes shapes(names);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        const KnownName* const known = find_known_name(names[c], shapes.chosen);
        matches[c].known = known && known->shape && shapes.is_users_own(*known->shape) ? nullptr : known;
    }

    const bool has_hit_columns = has_any_slot(matches, slot::t, slot::object);
    const bool has_directions = has_any_slot(matches, slot::direction, slot::tmax);
    ignore_foreign_names(names, has_hit_columns, has_directions, matches);

    // Gives each known column its slot. Of two columns of one number, the hexadecimal one is read, since it is exact.
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        const KnownName* const known = matches[c].known;
        if (known == nullptr) continue;
        const auto is_hex_twin = [&](const ColumnMatch& other) {
            return !matches[c].is_hex && other.is_hex && other.known != nullptr && other.known->slot == known->slot;
        };
        if (!std::ranges::any_of(matches, is_hex_twin)) give_slot(c, known->slot, known->shape, complain);
    }

    // Looks for typing errors, but only in words of three letters and more, and only for columns that are missing. The
    // letters of `a_x` are in too many words.
    const bool has_answer = has_hit_columns || has_any_slot(matches, slot::hit_index, slot::matrix);
    std::vector<std::string> missing;
    for (const KnownName& known : known_names()) {
        if (known.shape && shapes.chosen && shapes.is_users_own(*known.shape)) continue;
        if (known.slot >= slot::matrix && !has_any_of_matrix()) continue;
        if (known.slot > slot::hit_index && known.slot < slot::matrix &&
            (has_answer || has_directions == (known.slot == slot::inside)))
            continue;
        if (known.name.size() >= (known.shape ? 4 : 3) && !column_of_slot_[known.slot]) missing.push_back(known.name);
    }

    for (std::size_t c = 0; c < columns_.size(); ++c) {
        if (columns_[c].slot || matches[c].known != nullptr || columns_[c].name.size() < 3) continue;
        if (const auto closest_name = text::match_typo(columns_[c].name, missing))
            complain(
                c, fmt::format("unknown column \"{}\"; did you mean \"{}\"? (To keep a column of your own, rename it.)",
                               columns_[c].name, *closest_name));
    }
}

AnswerKind Layout::answer_kind() const {
    if (has(slot::hit_index)) return AnswerKind::all_hits;
    if (has(slot::inside)) return AnswerKind::inside;
    if (has(slot::crossings)) return AnswerKind::crossings;
    if (has(slot::parity)) return AnswerKind::parity;
    return has_first_hits() ? AnswerKind::first_hit : AnswerKind::none;
}

void Layout::require_one_kind(const Complain& complain) const {
    if (answer_kind() <= AnswerKind::first_hit) return;
    for (std::size_t s = slot::hit_index, before = slot::count; s < slot::matrix; ++s) {
        if (!has(s)) continue;
        if (before < s)
            complain(index_of(s), fmt::format("\"{}\" and \"{}\" are answers of two kinds; leave one of the two out",
                                              columns_[index_of(before)].name, columns_[index_of(s)].name));
        before = s;
    }
    const std::string name = columns_[index_of(slot_of(answer_kind()))].name;
    if (answer_kind() == AnswerKind::all_hits && !has(slot::object))
        complain(
            index_of(slot::hit_index),
            fmt::format("\"{}\" counts the hits of a ray, and no column says what they hit; add object, the number "
                        "of the triangle",
                        name));
    if (primitive_shape_ || has_matrix())
        complain(0,
                 fmt::format("\"{}\" is about the surface of a mesh, but each record has {}; leave those columns out",
                             name, primitive_shape_ ? "a primitive" : "a matrix"));
}

void Layout::complain_of_ray(const std::string& names, const Complain& complain) const {
    // Every word of two letters is one edit away from many others, so ask only if one alone is known to be missing.
    for (const LayoutColumn& column : columns_) {
        std::vector<std::string_view> similar_names;
        for (std::size_t s = 0; s < slot::tmax; ++s) {
            const std::string_view name = name_of_slot(s, {});
            if (!has(s) && !column.slot && text::edit_distance(column.name, name) == 1) similar_names.push_back(name);
        }
        if (similar_names.size() == 1)
            complain(
                static_cast<std::size_t>(&column - columns_.data()),
                fmt::format("a ray has no {}; is \"{}\" meant to be \"{}\"?", names, column.name, similar_names[0]));
    }
    complain(0, fmt::format("a ray has no {}: the columns are \"{}\"; name ox,oy,oz,dx,dy,dz, and optionally tmin, "
                            "tmax, hit and t (docs/judge.md lists these columns and those of a primitive)",
                            names, column_list(columns_)));
}

void Layout::require_complete(const Complain& complain) const {
    require_one_kind(complain);
    const auto missing_names = [&](std::size_t begin, std::size_t end, std::optional<Shape> shape) {
        std::string names;
        for (std::size_t s = begin; s < end; ++s) {
            if (!has(s) && !(shape && is_optional(*shape, s - slot::primitive)))
                names += (names.empty() ? "" : ", ") + std::string(name_of_slot(s, shape));
        }
        return names;
    };

    if (are_points()) {
        for (std::size_t k = 0; k < 3; ++k)
            if (!has(slot::origin + k))
                complain(0, fmt::format("a point has no p{}; name the columns px,py,pz,inside", "xyz"[k]));
        return;
    }

    if (const auto names = missing_names(0, slot::tmax, {}); !names.empty()) complain_of_ray(names, complain);

    if (const auto names = missing_names(slot::matrix, slot::count, {}); has_any_of_matrix() && !names.empty())
        complain(0, fmt::format("a matrix has no {}; write its three rows of four numbers, m00 to m23, or rename the "
                                "columns that do not belong to it",
                                names));

    if (!primitive_shape_) return;
    const std::size_t end = slot::primitive + row_of(*primitive_shape_).number_count;
    if (const auto names = missing_names(slot::primitive, end, *primitive_shape_); !names.empty())
        complain(0, fmt::format("{} has no {}; its columns are {}", with_article(*primitive_shape_), names,
                                fmt::join(column_names(*primitive_shape_), ",")));
}

bool Layout::has_any_of_matrix() const {
    return std::ranges::any_of(std::span(column_of_slot_).subspan(slot::matrix),
                               [](const auto& column) { return column.has_value(); });
}

std::vector<std::string> Layout::kept_columns() const {
    std::vector<std::string> names;
    for (const LayoutColumn& c : columns_) {
        if (!c.slot && !c.is_skipped) names.push_back(c.name);
    }
    return names;
}

std::vector<std::string> columns_of_name(std::string_view name, std::size_t count) {
    struct Group {
        std::string name;
        std::vector<std::string> parts;
    };

    // The names of vectors and of shapes, each with the columns that it stands for.
    static const std::vector<Group> groups = [] {
        std::vector<Group> known_groups{
            {"origin", {"ox", "oy", "oz"}},
            {"o", {"ox", "oy", "oz"}},
            {"direction", {"dx", "dy", "dz"}},
            {"dir", {"dx", "dy", "dz"}},
            {"d", {"dx", "dy", "dz"}},
            {"ray", {"ox", "oy", "oz", "dx", "dy", "dz"}},
            {"matrix", {matrix_columns.begin(), matrix_columns.end()}},
        };

        // A shape is a group as a whole, and each of its keys is one.
        for (const ShapeRow& shape_row : shape_rows) {
            const auto names = column_names(shape_row.shape);
            known_groups.push_back({std::string(shape_row.name), {names.begin(), names.end()}});
            std::size_t first_number = 0;
            for (const Key& key : shape_row.keys) {
                const auto part = names.subspan(first_number, key.count());
                for (const std::string_view group_name : {key.name, key.short_name, key.aliases[0], key.aliases[1]})
                    known_groups.push_back({std::string(group_name), {part.begin(), part.end()}});
                first_number += key.count();
            }
        }
        return known_groups;
    }();

    const std::string lower_name = to_lower_case(name);
    for (const Group& group : groups) {
        if (group.name == lower_name && group.parts.size() == count) return group.parts;
    }
    return {};
}

}  // namespace lostbits::scene::ray_file
