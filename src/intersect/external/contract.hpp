// The contract of an external intersector, and its conversion to a form of the table.
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
    int bits = 32;  ///< bits of the number format that the form takes: 32 or 64
    Direction direction = Direction::any;
    Roots roots = Roots::both;
    Touching touching = Touching::hit;
    AtOrigin at_origin = AtOrigin::hit;
    Inside inside = Inside::usual;
    Facing facing = Facing::both;
    unsigned flags = 0;  ///< LB_LINE, LB_NO_END, LB_ONE_THREAD, LB_CLIPPED, LB_RANGE
    /// State of the processor in which the form computes, as loading the library left it
    /// (`FloatingPointState::differences`). Empty for the state that IEEE 754 asks for.
    std::string state = {};

    friend bool operator==(const Contract&, const Contract&) = default;
};

/// A contract and the function that answers for it.
struct ForeignForm {
    Contract contract;
    std::string provider;  ///< the library or the command that provides the form, for messages
    /// Fills `near_far` and `hit` of a batch. Throws an Error that names `from` if the form cannot answer.
    std::function<void(const lb_batch&)> answer;
    bool is_isolated = false;  ///< true if the form runs in another process, so that its crash does not end this one
};

/// Returns `LIBRARY: form "NAME"`, for messages.
inline std::string name_in_messages(const ForeignForm& form) {
    return form.provider + ": form \"" + form.contract.name + "\"";
}

/// Converts the contract that a library states. Throws InputError, which begins with `library`, for an invalid
/// contract.
Contract read_form_contract(const lb_form& form, const std::string& library);

/// Throws InputError if a property of a contract is not valid, or if two of them contradict each other; `library`
/// begins the message.
void require_valid(const Contract& contract, const std::string& library);

/// Throws InputError if only hits from one side count but the shape has no front and back; `message_prefix` begins the
/// message.
void require_valid_facing(Facing facing, Shape shape, const std::string& message_prefix);

/// Returns the correct answer for a ray from inside: the contract's property `inside`, or else the answer that follows
/// from its roots. Returns `usual` if that answer is the usual one of the shape.
Inside inside_of(const Contract& contract);

/// Converts the contract to the `Info` of a form of the catalogue, which points to the texts of the contract.
Info make_info(const Contract& contract);

/// Adds the forms in the table of intersectors, which keeps them until the program ends. Two forms of one name in
/// different formats become one form. Throws InputError if two forms of one name differ in more than the format, or if
/// a form of the table already has the name.
void register_forms(std::vector<ForeignForm> forms);

/// Returns the external forms of a form: one, or one for each of two formats. Empty for a form of the catalogue.
std::vector<const ForeignForm*> find_foreign_forms(const table::Intersector& form);

/// True if a call of the form cannot crash or hang this process: for a form of the catalogue, or of isolated forms.
bool is_safe_to_run(const table::Intersector& form);

}  // namespace lostbits::intersect::external
