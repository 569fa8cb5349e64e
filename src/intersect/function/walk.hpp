// Runs a function of LLVM IR over recorded numbers. An integer or a pointer is known, or is one of a few that decisions
// choose from. Other numbers are operations. Both sides of a branch are run, and their results are joined by choices.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "intersect/function/ir.hpp"
#include "intersect/function/nodes.hpp"

namespace lostbits::intersect::function {

/// An integer or an address that holds under a decision.
struct Case {
    Mask when = yes;
    int object = 0;  ///< the object that an address points into; 0: an integer
    std::int64_t value = 0;
    friend bool operator==(const Case&, const Case&) = default;
};

struct Scalar {
    enum class Kind { undefined, lost, number, whole };
    Kind kind = Kind::undefined;
    NodeId node = no_node;         ///< operation of a number
    std::vector<Case> cases = {};  ///< cases of an integer or an address: exactly one holds
    std::string why = {};          ///< reason, for a value that is lost
    friend bool operator==(const Scalar&, const Scalar&) = default;
};

struct MemoryCell {
    std::size_t size = 0;
    Scalar scalar;
    friend bool operator==(const MemoryCell&, const MemoryCell&) = default;
};

/// A value of any type: its scalars by their offsets in memory. Missing bytes are undefined.
using Value = std::map<std::size_t, MemoryCell>;

class Walk {
public:
    /// `own` is the folder of the user's file; operations in headers elsewhere are shown at the call in the user's
    /// file. `ir_file` is the module itself if that is the user's file; functions without debug information are then
    /// shown as its lines.
    Walk(Module& module, Nodes& nodes, std::string own, std::string ir_file = {})
        : module_(module), nodes_(nodes), own_(std::move(own)), ir_file_(std::move(ir_file)) {}

    struct Answer {
        Mask hit;
        NodeId t, far;  ///< none if it is not written
    };
    /// Runs `void NAME(const T* in, T* out, int* hit)`. `in` holds `inputs` numbers; `out` receives t and the far t.
    /// Throws InputError with the place of anything that cannot be followed.
    Answer run(const std::string& name, int inputs);

    [[nodiscard]] const std::vector<SourcePlace>& places() const { return places_; }
    /// The innermost place in the user's own files, or -1.
    [[nodiscard]] int own_place(int place) const;

private:
    using Registers = std::unordered_map<std::string, Value>;
    struct State {
        std::vector<Mask> path;  ///< decisions that all hold here
        std::vector<std::shared_ptr<Value>> memory;
        Registers registers;
    };
    /// A function that runs.
    struct Frame {
        const IrFunction* function;
        int caller;              ///< place of the call
        std::vector<int> order;  ///< position of each block
        std::map<std::string, int> blocks;
        std::map<int, State> pending;  ///< by position of the block
        std::vector<int> visits;
        std::optional<State> returned = {};
        std::string block = {};  ///< the block that runs
    };

    // Values
    [[noreturn]] void fail(const std::string& what) const { throw NotFollowed(what); }
    Value whole(std::vector<Case> cases, std::size_t size) const;
    Value integer(std::int64_t value, const Type& type) const { return whole({{yes, 0, value}}, type.size); }
    Value number(NodeId node) const;
    Value from_mask(Mask m, std::size_t size = 1);
    NodeId number_of(const Value& value, const Type& type);
    std::vector<Case> cases_of(const Value& value, const Type& type);
    Mask mask_of(const Value& value);
    std::optional<Scalar> slice(const Scalar& scalar, std::size_t size, std::size_t from, std::size_t count);
    Value part_of(const Value& value, std::size_t from, std::size_t count);
    void put(Value& into, std::size_t at, std::size_t size, const Value& value);
    Scalar join(Mask when, const Scalar& a, const Scalar& b, std::size_t size);
    Value join(Mask when, const Value& a, const Value& b);
    std::vector<Case> distinct(std::vector<Case> cases);
    Value zero(const Type& type);
    std::optional<NodeId> from_bits(const Scalar& scalar, std::size_t size);

    // States
    void join(State& into, State&& other);
    int new_object(State& state, bool is_written = true);
    Value load(State& state, const Value& pointer, std::size_t size);
    void store(State& state, const Value& pointer, std::size_t size, const Value& value);
    void enter(Frame& frame, State state, const std::string& target);
    void branch(Frame& frame, State& state, Mask when, const std::string& target);
    void take_return(Frame& frame, State& state, Value value);
    std::optional<std::pair<State, Value>> call(const IrFunction& f, std::vector<Value> arguments, State state,
                                                int caller);

    // Instructions
    Value value(State& state, const Type& type, Cursor& at);
    Value constant(State& state, const Type& type, Cursor& at);
    Value address_of(State& state, const std::string& global);
    Value element_address(State& state, Cursor& at);
    NodeId literal(const Type& type, Cursor& at);
    /// False if the block ends.
    bool step(Frame& frame, State& state, std::string_view line);
    bool end_block(Frame& frame, State& state, std::string_view op, Cursor& at);
    Value compute(Frame& frame, State& state, std::string_view op, Cursor& at);
    Value arithmetic(State& state, std::string_view op, Cursor& at);
    Value compare_numbers(State& state, Cursor& at);
    Value compare_wholes(State& state, Cursor& at);
    Value whole_arithmetic(State& state, std::string_view op, Cursor& at);
    Value combine(std::string_view op, const Type& type, const Value& a, const Value& b);
    std::optional<Value> on_bits(std::string_view op, const Type& type, const Value& a, const Value& b);
    Value converted(State& state, std::string_view op, Cursor& at);
    Value shuffled(State& state, std::string_view op, Cursor& at);
    std::optional<Value> called(Frame& frame, State& state, Cursor& at);
    std::optional<Value> known_call(State& state, const std::string& name, const Type& type,
                                    const std::vector<Value>& arguments, const std::vector<const Type*>& types);
    template <class Act>
    Value each_lane(const Type& type, const Act& act);

    // Places and names
    int index_of(std::string_view line, const Frame& frame);
    int ir_place(std::string_view line, int caller);
    int place_at(int location, int caller);
    void name_value(State& state, int variable, const Value& value, std::size_t from, int depth);
    void declare(State& state, std::string_view line, Cursor at, bool is_record);

    Module& module_;
    Nodes& nodes_;
    std::string own_, ir_file_;
    std::vector<SourcePlace> places_;
    std::map<std::pair<int, int>, int> known_places_;
    std::map<std::string, int> global_objects_;
    std::map<int, std::string> functions_;          // objects that are functions
    std::map<int, std::pair<int, int>> variables_;  // by object: the variable, and the depth of calls
    std::map<int, Value> global_memory_;            // contents of global constants
    int objects_ = 1;
    int depth_ = 0, nesting_ = 0;
    std::size_t steps_ = 0;
};

}  // namespace lostbits::intersect::function
