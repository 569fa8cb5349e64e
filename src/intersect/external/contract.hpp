// The contract of an external intersector, and its conversion to a row of the table.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lostbits_plugin.h>
#include "intersect/table/table.hpp"

namespace lostbits::intersect::external {

/// The contract of a form in one format.
struct Contract {
    std::string name, title, source;
    Shape shape{};
    int bits = 32;  ///< format of the numbers that it takes: 32 or 64
    Direction direction = Direction::any;
    Roots roots = Roots::both;
    Touching touching = Touching::hit;
    AtOrigin at_origin = AtOrigin::hit;
    Inside inside = Inside::usual;
    Facing facing = Facing::both;
    unsigned flags = 0;  ///< LB_LINE, LB_NO_END, LB_ONE_THREAD, LB_CLIPPED, LB_RANGE
    /// State of the processor that loading the library left, in which the form computes (`FloatingPoint::differences`);
    /// empty: as IEEE 754 asks.
    std::string state = {};

    friend bool operator==(const Contract&, const Contract&) = default;
};

/// A contract and the function that answers for it.
struct ForeignForm {
    Contract contract;
    std::string from;  ///< the library or the command, for messages
    /// Fills `near_far` and `hit` of a batch; throws an Error that names `from` if it cannot.
    std::function<void(const lb_batch&)> answer;
    bool isolated = false;  ///< it answers from another process, so its crash does not end this one
};

/// `LIBRARY: form "NAME"`, for messages.
inline std::string name_in_messages(const ForeignForm& form) {
    return form.from + ": form \"" + form.contract.name + "\"";
}

/// Converts the contract that a library states. InputError, which begins with `from`, for an invalid one.
Contract contract_of(const lb_form& form, const std::string& from);

/// Throws InputError if the properties of a contract contradict each other; `from` begins the message.
void require_sense(const Contract& contract, const std::string& from);

/// Throws InputError if only one side is to count and the shape has no front; `from` begins the message.
void require_front(Facing facing, Shape shape, const std::string& from);

/// The true answer from inside by a contract: its own property, or else the one that follows from its roots. `usual` if
/// the primitive has that anyway.
Inside inside_of(const Contract& contract);

/// Converts the contract to the `Info` of a form of the catalogue. It points to the texts of the contract.
Info info_of(const Contract& contract);

/// Adds the forms as rows of the table, which the program keeps until it ends; a name that comes in two formats becomes
/// one row. InputError if two forms of a name differ in more than the format, or if a row of the table has the name.
void register_forms(std::vector<ForeignForm> forms);

/// Forms that an enrolled row is made of: one, or one for each of two formats. Empty for a row of the catalogue.
std::vector<const ForeignForm*> behind(const table::Intersector& row);

/// True if asking a row can do no harm to this process: a row of the catalogue, or of isolated forms.
bool is_safe_to_run(const table::Intersector& row);

}  // namespace lostbits::intersect::external
