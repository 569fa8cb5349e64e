#include "scene/ray_file/chunk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "number/error.hpp"
#include "shapes/given_matrix.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::scene::ray_file {

ChunkWriter::ChunkWriter(const Layout& layout, const ReadSettings& settings, std::size_t record_count, Chunk& chunk)
    : layout_(layout),
      settings_(settings),
      chunk_(chunk),
      answers_(layout.answer_kind()),
      shape_(layout.primitive_shape()),
      has_answers_(layout.has_first_hits()) {
    if (layout.has_matrix() && settings.transformed_primitive) shape_ = settings.transformed_primitive->shape;
    rays::RayBlock& rays = chunk.rays;
    for (auto* column : rays.numbers()) column->reserve(record_count);
    if (layout.has(slot::tmin)) rays.tmin.reserve(record_count);
    if (layout.has(slot::tmax)) rays.tmax.reserve(record_count);
    rays.open_ends = settings.open_ends;
    if (shape_) chunk.primitives.reserve(record_count);
    if (has_answers_) {
        chunk.t.reserve(record_count);
        chunk.hit.reserve(record_count);
    }
    if (layout.has(slot::object)) chunk.object.reserve(record_count);
    if (answers_ > AnswerKind::first_hit) chunk.counts.reserve(record_count);
}

std::string ChunkWriter::slot_name(std::size_t slot) const {
    return layout_.has(slot) ? layout_.columns()[layout_.index_of(slot)].name : std::string(name_of_slot(slot, shape_));
}

void ChunkWriter::fail(const std::string& message_prefix, const std::string& why) {
    throw InputError(message_prefix + ": " + why);
}

namespace {

std::string index_advice(std::size_t primitive_count) {
    if (primitive_count == 1) return "there is one primitive, number 0; write 0, or -1 or nothing if it was not hit";
    return fmt::format(
        "there are {} primitives, numbered from 0 to {} in the order of the scene; write the number of the one that "
        "was hit, or -1 or nothing if none was",
        primitive_count, primitive_count - 1);
}

}  // namespace

ChunkWriter::RecordFault ChunkWriter::fault_at(std::size_t slot, std::string_view why) const {
    const std::string value = is_present(slot) ? fmt::format("is {}", numbers_[slot]) : "is empty";
    return RecordFault{slot, fmt::format("{} {}; {}", slot_name(slot), value, why)};
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault() {
    if (const auto fault = find_fault_of_ray()) return fault;
    if (const auto fault = find_fault_of_range()) return fault;
    if (const auto fault = find_fault_of_primitive()) return fault;
    if (const auto fault = find_fault_of_matrix()) return fault;
    if (const auto fault = find_fault_of_object()) return fault;
    if (answers_ > AnswerKind::first_hit) return find_fault_of_count();
    if (!has_answers_) return std::nullopt;
    if (const auto fault = find_fault_of_answer()) return fault;

    // A hit needs its primitive, unless that is the record's own.
    const bool names_primitive = layout_.has(slot::object) && !shape_;
    if (is_hit_ && names_primitive && !(is_present(slot::object) && numbers_[slot::object] >= 0))
        return fault_at(slot::object,
                        fmt::format("{} says that the ray hits; write the number of the primitive that it hit, from 0, "
                                    "or say that it misses",
                                    slot_name(layout_.has(slot::hit) ? slot::hit : slot::t)));
    return std::nullopt;
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_ray() const {
    const auto& numbers = numbers_;
    for (std::size_t s = slot::origin; s < (layout_.are_points() ? slot::direction : slot::tmax); ++s) {
        if (!is_present(s) || !std::isfinite(numbers[s]))
            return fault_at(
                s, layout_.are_points()
                       ? "a point has three finite numbers; leave this point out"
                       : "a ray has six finite numbers; leave this ray out, or write it as a [[case]], which may hold "
                         "any numbers");
    }
    if (!layout_.are_points() && numbers[3] == 0 && numbers[4] == 0 && numbers[5] == 0)
        return RecordFault{slot::direction,
                           "the direction is 0,0,0, so this record is not a ray; leave the record out"};
    return std::nullopt;
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_range() const {
    const auto& numbers = numbers_;
    if (is_present(slot::tmax) && std::isnan(numbers[slot::tmax]))
        return fault_at(slot::tmax, "write where the ray ends, or inf (or nothing) for a ray without end");

    if (is_present(slot::tmin) && !(numbers[slot::tmin] >= 0 && numbers[slot::tmin] < HUGE_VAL))
        return fault_at(
            slot::tmin,
            "a ray looks ahead, and its range begins at a finite t of 0 or more; write that, or nothing for 0");

    if (const Range<double> range = this->range(); !range.holds_any()) {
        // With open ends, a range is empty if its ends are equal.
        const std::size_t s = is_present(slot::tmax) ? slot::tmax : slot::tmin;
        return fault_at(s, fmt::format("the range of this ray begins at tmin = {} and ends at tmax = {}, and no t lies "
                                       "between; write a tmax above tmin, or leave this ray out",
                                       range.tmin, range.tmax));
    }
    return std::nullopt;
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_primitive() const {
    if (!shape_) return std::nullopt;
    const std::size_t count = row_of(*shape_).number_count;
    for (std::size_t s = slot::primitive; s < slot::primitive + count; ++s) {
        if (!layout_.has(s)) continue;  // the column is optional, and the number 0
        if (!is_present(s) || !std::isfinite(numbers_[s]))
            return fault_at(s,
                            fmt::format("{} has {} finite numbers; leave this ray out", with_article(*shape_), count));
    }
    return find_fault_of_limits();
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_limits() const {
    const auto broken = broken_limit(primitive());
    if (!broken) return std::nullopt;
    const std::size_t s = slot::primitive + broken->number_index;
    const std::string name = with_article(*shape_);
    if (broken->key->limit == Key::Limit::positive)
        return fault_at(s, fmt::format("{} of {} must be greater than 0; leave this ray out", broken->key->name, name));
    if (broken->key->limit != Key::Limit::at_least_previous)
        return fault_at(s,
                        fmt::format("{} {}; or leave this ray out", broken->key->name, limit_phrase(*shape_, *broken)));

    // Names the lower one of two corners in the wrong order.
    const std::size_t lower_slot = s - broken->key->count();
    return fault_at(lower_slot, fmt::format("it is above {}, which is {}; {} has {} in each component", slot_name(s),
                                            numbers_[s], name, order_phrase(*broken->key)));
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_matrix() const {
    if (!layout_.has_matrix()) return std::nullopt;
    for (std::size_t s = slot::matrix; s < slot::count; ++s) {
        if (!is_present(s) || !std::isfinite(numbers_[s]))
            return fault_at(s, "a matrix has twelve finite numbers; leave this ray out");
    }
    if (!primitive().transform->is_proper())
        return RecordFault{slot::matrix, fmt::format("the matrix {}, or leave this ray out", singular_reason)};
    return std::nullopt;
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_object() const {
    const double object = numbers_[slot::object];
    if (is_present(slot::object) && !(object >= -1 && object < 0x1p31 && object == std::floor(object)))
        return fault_at(slot::object,
                        "write the number of the primitive that was hit, from 0, or -1 or nothing if none was");
    if (is_present(slot::object) && settings_.primitives && object >= static_cast<double>(*settings_.primitives))
        return fault_at(slot::object, index_advice(*settings_.primitives));
    return std::nullopt;
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_answer() {
    const double t = numbers_[slot::t];

    // A column `hit` decides; a hit needs a t then.
    if (layout_.has(slot::hit)) {
        const double hit = numbers_[slot::hit];
        if (!is_present(slot::hit) || !(hit == 0 || hit == 1)) {
            const std::string value = is_present(slot::hit) ? fmt::format("is {}", hit) : "is empty";
            return RecordFault{slot::hit,
                               fmt::format("{} {}; write 1 for a hit and 0 for a miss", slot_name(slot::hit), value)};
        }
        is_hit_ = hit == 1;
        if (is_hit_ && layout_.has(slot::t) && !is_present(slot::t))
            return RecordFault{slot::t,
                               fmt::format("{} is empty, but {} is 1; write the t of the hit, nan if it is not a "
                                           "number, or 0 as {}",
                                           slot_name(slot::t), slot_name(slot::hit), slot_name(slot::hit))};
        return {};
    }

    // Otherwise t decides, by the rule for misses.
    is_hit_ = is_present(slot::t) && std::isfinite(t);
    if (!is_hit_) return {};
    switch (settings_.miss.kind) {
        case MissRule::Kind::never: return {};
        case MissRule::Kind::negative: is_hit_ = !(t < 0); return {};
        case MissRule::Kind::number: is_hit_ = t != settings_.miss.number; return {};
        case MissRule::Kind::refuse_negative: break;
    }
    if (!(t < 0)) return {};

    return RecordFault{slot::t,
                       fmt::format("{} is {}, and no column says whether that is a hit; add a column hit, or write "
                                   "--miss {} if this number means a miss, --miss negative if every negative "
                                   "one does, --miss never if it is an answer",
                                   slot_name(slot::t), t, t)};
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_count() {
    if (answers_ == AnswerKind::all_hits) return find_fault_of_hit_index();
    const std::size_t s = slot_of(answers_);
    const double count = numbers_[s], most = answers_ == AnswerKind::crossings ? 0x1p31 - 1 : 1;
    if (is_present(s) && count >= 0 && count <= most && count == std::floor(count)) return {};
    return RecordFault{
        s,
        fmt::format("{} {}; write {}", slot_name(s), is_present(s) ? fmt::format("is {}", count) : "is empty",
                    answers_ == AnswerKind::crossings ? "how often the ray crosses the surface, from 0"
                    : answers_ == AnswerKind::parity ? "1 if the ray crosses the surface an odd number of times, else 0"
                                                     : "1 for a point inside and 0 for one outside")};
}

std::optional<ChunkWriter::RecordFault> ChunkWriter::find_fault_of_hit_index() {
    const double index = is_present(slot::hit_index) ? numbers_[slot::hit_index] : -1;
    const auto fault_of_index = [this, index](const std::string& why) {
        return RecordFault{slot::hit_index, fmt::format("{} is {}; {}", slot_name(slot::hit_index), index, why)};
    };

    // The index counts the hits of a ray from 0, or is −1 without an object.
    if (!(index >= -1 && index < 0x1p31 && index == std::floor(index)))
        return fault_of_index(
            "write 0 for the first hit of a ray, 1 for the next and so on, and -1 or nothing for no hit");
    is_hit_ = index >= 0;
    if (!is_hit_ && is_present(slot::object) && numbers_[slot::object] >= 0)
        return RecordFault{slot::hit_index,
                           fmt::format("{} says that the ray has no hit, but {} is {}; write 0 for its first "
                                       "hit, or leave {} empty",
                                       slot_name(slot::hit_index), slot_name(slot::object), numbers_[slot::object],
                                       slot_name(slot::object))};

    // The hits of one ray follow each other.
    if (const auto previous_index = chunk_.counts.empty() ? std::optional<std::int32_t>() : chunk_.counts.back();
        index > 0 && previous_index) {
        if (index != *previous_index + 1.0)
            return fault_of_index(
                fmt::format("the hit_index before it is {}; the hits of a ray follow each other in the order of "
                            "their hit_index, from 0",
                            *previous_index));
        const Ray<double> ray = chunk_.rays[chunk_.rays.size() - 1];
        for (int k = 0; k < 3; ++k)
            if (ray.origin[k] != numbers_[k] || ray.direction[k] != numbers_[k + 3])
                return fault_of_index(
                    "the record before it is of another ray; write the same ray in all records of its hits");
    }

    // A hit names its triangle and has a t.
    if (is_hit_ && !(is_present(slot::object) && numbers_[slot::object] >= 0))
        return RecordFault{slot::object, fmt::format("{} is {}; write the number of the triangle that is hit, from 0",
                                                     slot_name(slot::hit_index), index)};
    if (is_hit_ && layout_.has(slot::t) && !is_present(slot::t))
        return RecordFault{slot::t,
                           fmt::format("{} is empty, but {} is {}; write the t of the hit, or nan if it is not a "
                                       "number",
                                       slot_name(slot::t), slot_name(slot::hit_index), index)};
    return {};
}

Range<double> ChunkWriter::range() const {
    return {is_present(slot::tmin) ? numbers_[slot::tmin] : 0, is_present(slot::tmax) ? numbers_[slot::tmax] : HUGE_VAL,
            settings_.open_ends};
}

Primitive<double> ChunkWriter::primitive() const {
    Primitive<double> primitive = settings_.transformed_primitive.value_or(Primitive<double>(*shape_));
    for (std::size_t k = 0; !settings_.transformed_primitive && k < primitive.shape_numbers().size(); ++k)
        primitive.numbers[k] = numbers_[slot::primitive + k];
    if (!layout_.has_matrix()) return primitive;
    std::array<double, Affine<double>::number_count> matrix;
    std::copy_n(numbers_ + slot::matrix, matrix.size(), matrix.begin());
    primitive.transform = transform_of(matrix);
    return primitive;
}

void ChunkWriter::store_record() {
    const auto& numbers = numbers_;
    chunk_.rays.push({{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}});
    const Range<double> range = this->range();
    if (layout_.has(slot::tmin)) chunk_.rays.tmin.push_back(range.tmin);
    if (layout_.has(slot::tmax)) chunk_.rays.tmax.push_back(range.tmax);
    if (shape_) {
        chunk_.primitives.push_back(primitive());
    }
    if (has_answers_) {
        chunk_.hit.push_back(is_hit_ ? 1 : 0);
        chunk_.t.push_back(is_hit_ && is_present(slot::t) ? numbers[slot::t] : 0);
    }
    if (answers_ == AnswerKind::all_hits)
        chunk_.counts.push_back(is_hit_ ? static_cast<std::int32_t>(numbers[slot::hit_index]) : -1);
    else if (answers_ > AnswerKind::first_hit)
        chunk_.counts.push_back(static_cast<std::int32_t>(numbers[slot_of(answers_)]));
    if (layout_.has(slot::object))
        chunk_.object.push_back(is_present(slot::object) ? static_cast<std::int32_t>(numbers[slot::object]) : -1);
    present_ = 0;
}

}  // namespace lostbits::scene::ray_file
