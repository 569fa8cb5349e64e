// What an intersector from outside says of itself, and how it becomes a row of the table.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lostbits_plugin.h>
#include "intersect/table/table.hpp"

namespace lostbits::intersect::doors {

/// The contract of a form in one format.
struct Contract {
    std::string name, title, source;
    Shape shape{};
    int bits = 32;  ///< of the numbers that it takes: 32 or 64
    Direction direction = Direction::any;
    Roots roots = Roots::both;
    Touching touching = Touching::hit;
    AtOrigin at_origin = AtOrigin::hit;
    Inside inside = Inside::usual;
    Facing facing = Facing::both;
    unsigned flags = 0;  ///< LB_LINE, LB_NO_END, LB_ONE_THREAD, LB_CLIPPED, LB_RANGE
    /// How the processor computes in it, which loading its library left (`FloatingPoint::words`); empty: as IEEE 754
    /// asks.
    std::string state = {};

    friend bool operator==(const Contract&, const Contract&) = default;
};

/// A contract together with what answers it.
struct ForeignForm {
    Contract contract;
    std::string from;  ///< the library or the command, for messages
    /// Fills `near_far` and `hit` of a batch; throws an Error that names `from` where it cannot.
    std::function<void(const lb_batch&)> answer;
    bool isolated = false;  ///< it answers from another process, and no fault of its own ends this one
};

/// `LIBRARY: form "NAME"`: who did something.
inline std::string name_in_messages(const ForeignForm& form) {
    return form.from + ": form \"" + form.contract.name + "\"";
}

/// As a library states it. InputError, which begins with `from`, for what makes no sense.
Contract contract_of(const lb_form& form, const std::string& from);

/// InputError where the words of a contract contradict each other; `from` begins the message.
void require_sense(const Contract& contract, const std::string& from);

/// InputError where one side is to count of what has no front; `from` begins the message.
void require_front(Facing facing, Shape shape, const std::string& from);

/// The true answer from inside by a contract: what it says, else as its roots have it. `usual` where that is what the
/// solid has anyway.
Inside inside_of(const Contract& contract);

/// The same words as those of a form of the catalogue. It points to the texts of the contract.
Info info_of(const Contract& contract);

/// The form as rows of the table, which the program keeps until it ends; a name that comes in two formats becomes one
/// row. InputError where two of a name differ in more than the format, or a row of the table has the name.
void enroll(std::vector<ForeignForm> forms);

/// What an enrolled row is made of: one form, or one for each of two formats. Empty for a row of the catalogue.
std::vector<const ForeignForm*> behind(const table::Intersector& row);

/// Whether asking a row can do no harm to this process: one of the catalogue, or of forms that are isolated.
bool is_harmless(const table::Intersector& row);

}  // namespace lostbits::intersect::doors
