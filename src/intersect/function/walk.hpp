// Runs a function of LLVM IR over recorded numbers. A floating-point number is the result of a recorded operation. An
// integer or a pointer has a known value, or one of a few values between which recorded decisions choose. Both sides of
// a branch are run, and selections join their results.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "intersect/function/ir.hpp"
#include "intersect/function/nodes.hpp"

namespace lostbits::intersect::function {

/// One possible value of an integer or an address: the value if the decision `when` is true.
struct PossibleValue {
    Mask when = yes;
    int memory_object = 0;   ///< index of the variable or buffer that an address points into; 0 for an integer
    std::int64_t value = 0;  ///< the integer, or the offset of an address in bytes
    friend bool operator==(const PossibleValue&, const PossibleValue&) = default;
};

struct Scalar {
    /// `lost`: a value that is not followed; an instruction that uses it fails with `reason`.
    enum class Kind { undefined, lost, number, integer };
    Kind kind = Kind::undefined;
    NodeId node = no_node;                  ///< operation of a number
    std::vector<PossibleValue> cases = {};  ///< possible values of an integer or an address; exactly one `when` is true
    std::string reason = {};                ///< why a value is lost
    friend bool operator==(const Scalar&, const Scalar&) = default;
};

struct MemoryCell {
    std::size_t size = 0;
    Scalar scalar;
    friend bool operator==(const MemoryCell&, const MemoryCell&) = default;
};

/// A value of any type: its scalars, by their offsets in bytes. Bytes without a scalar are undefined.
using Value = std::map<std::size_t, MemoryCell>;

class Walk {
public:
    /// `user_folder` is the folder of the user's file; operations in headers elsewhere are shown at the call in the
    /// user's file. `ir_file` is the path of the module if the module is the user's file; functions without debug
    /// information are then shown as lines of the module.
    Walk(Module& module, Nodes& nodes, std::string user_folder, std::string ir_file = {})
        : module_(module), nodes_(nodes), user_folder_(std::move(user_folder)), ir_file_(std::move(ir_file)) {}

    struct Answer {
        Mask hit;
        NodeId t, far;  ///< `no_node` if the function does not write it
    };
    /// Runs `void NAME(const T* in, T* out, int* hit)`. `in` holds `inputs` numbers; `out` receives t and the far t.
    /// Throws InputError with the place of anything that cannot be followed.
    Answer run(const std::string& name, int input_count);

    [[nodiscard]] const std::vector<SourcePlace>& places() const { return places_; }
    /// A number that a variable of the user's function receives: `v[0]` of `float v[3]`.
    struct StoredNumber {
        std::string name;
        NodeId node;
        int place, declaration_line;  ///< index of the place of the statement, and line of the declaration
    };
    /// All stored numbers, in the order in which the function stores them.
    [[nodiscard]] const std::vector<StoredNumber>& stored() const { return stored_; }
    /// Index of the innermost place in the user's files on the chain of calls that leads to `place`; -1 if no
    /// place of the chain is in these files.
    [[nodiscard]] int innermost_user_place(int place) const;

private:
    using Registers = std::unordered_map<std::string, Value>;
    struct MemoryState {
        std::vector<Mask> path;  ///< the decisions that led to this state; all are true in it
        std::vector<std::shared_ptr<Value>> memory;
        Registers registers;
    };
    /// A call of a function that is running.
    struct CallFrame {
        const IrFunction* function;
        int caller;                  ///< index of the place of the call
        std::vector<int> positions;  ///< position of each block in the order in which blocks run
        std::map<std::string, int> blocks;
        std::map<int, MemoryState> pending;  ///< states that wait at the start of a block, by the position of the block
        std::vector<int> visits;
        std::optional<MemoryState> returned = {};
        std::string block = {};  ///< name of the block that is running
    };

    // Values
    [[noreturn]] void fail(const std::string& problem) const { throw NotFollowed(problem); }
    Value integer_from_cases(std::vector<PossibleValue> cases, std::size_t size) const;
    Value integer(std::int64_t value, const Type& type) const {
        return integer_from_cases({{yes, 0, value}}, type.size);
    }
    Value number(NodeId node) const;
    Value integer_from_mask(Mask m, std::size_t size = 1);
    NodeId number_of(const Value& value, const Type& type);
    std::vector<PossibleValue> cases_of(const Value& value, const Type& type);
    std::vector<PossibleValue> cases_of_cell(const MemoryCell& cell) const;
    std::vector<PossibleValue> insert_bytes(const std::vector<PossibleValue>& integers,
                                            const std::vector<PossibleValue>& cell_cases, std::size_t offset,
                                            std::size_t size);
    Mask mask_of(const Value& value);
    std::optional<Scalar> slice(const Scalar& scalar, std::size_t size, std::size_t first_byte, std::size_t count);
    Value extract_bytes(const Value& value, std::size_t first_byte, std::size_t count);
    void write_bytes(Value& target, std::size_t offset, std::size_t size, const Value& value);
    Scalar join(Mask when, const Scalar& a, const Scalar& b, std::size_t size);
    Value cut_like(const Value& value, const Value& pattern);
    Value join(Mask when, const Value& a, const Value& b);
    std::vector<PossibleValue> merge_duplicates(std::vector<PossibleValue> cases);
    Value zero_value(const Type& type);
    std::optional<NodeId> number_from_bits(const Scalar& scalar, std::size_t size);

    // States
    void join(MemoryState& state, MemoryState&& other);
    void join_memory(Mask when, MemoryState& state, const MemoryState& other);
    void join_registers(Mask when, Registers& registers, const Registers& others);
    int add_object(MemoryState& state, bool is_written = true);
    Value load(MemoryState& state, const Value& pointer, std::size_t size);
    Value load_from(const MemoryState& state, const PossibleValue& address, std::size_t size);
    void store(MemoryState& state, const Value& pointer, std::size_t size, const Value& value);
    void enter(CallFrame& frame, MemoryState state, const std::string& target);
    std::vector<std::pair<std::string, Value>> read_phis(const CallFrame& frame, MemoryState& state,
                                                         const Block& block);
    std::optional<Value> read_phi(const CallFrame& frame, MemoryState& state, const Type& type, Cursor& cursor);
    void branch(CallFrame& frame, MemoryState& state, Mask when, const std::string& target);
    void add_return_state(CallFrame& frame, MemoryState& state, Value value);
    std::optional<std::pair<MemoryState, Value>> run_function(const IrFunction& function, std::vector<Value> arguments,
                                                              MemoryState state, int caller);
    static CallFrame make_frame(const IrFunction& function, int caller);
    void set_parameters(MemoryState& state, const IrFunction& function, const std::vector<Value>& arguments);
    void run_blocks(CallFrame& frame);
    Answer read_answer(const MemoryState& state);

    // Instructions
    Value value(MemoryState& state, const Type& type, Cursor& cursor);
    Value constant(MemoryState& state, const Type& type, Cursor& cursor);
    Value read_composite(MemoryState& state, const Type& type, Cursor& cursor);
    Value read_byte_string(const Type& type, Cursor& cursor);
    Value read_integer(const Type& type, Cursor& cursor);
    Value address_of(MemoryState& state, const std::string& global);
    Value element_address(MemoryState& state, Cursor& cursor);
    const Type* move_to_member(std::vector<PossibleValue>& addresses, const Type& structure,
                               const std::vector<PossibleValue>& index);
    std::vector<PossibleValue> move_by_items(const std::vector<PossibleValue>& addresses,
                                             const std::vector<PossibleValue>& item_counts, std::size_t item_size);
    NodeId read_literal(const Type& type, Cursor& cursor);
    /// Runs one instruction. Returns false if the block ends.
    bool run_instruction(CallFrame& frame, MemoryState& state, std::string_view line);
    bool call(MemoryState& state, const std::string& result, Cursor& cursor);
    void invoke(CallFrame& frame, MemoryState& state, std::string_view line, const std::string& result, Cursor& cursor);
    void name_after_register(const std::string& register_name, const Value& value);
    void end_block(CallFrame& frame, MemoryState& state, std::string_view op, Cursor& cursor);
    void run_switch(CallFrame& frame, MemoryState& state, Cursor& cursor);
    Value compute(MemoryState& state, std::string_view op, Cursor& cursor);
    Value run_load(MemoryState& state, Cursor& cursor);
    void run_store(MemoryState& state, Cursor& cursor);
    Value run_select(MemoryState& state, Cursor& cursor);
    Value arithmetic(MemoryState& state, std::string_view op, Cursor& cursor);
    Value compare_numbers(MemoryState& state, Cursor& cursor);
    Value compare_integers(MemoryState& state, Cursor& cursor);
    Mask decide(std::string_view predicate, NodeId x, NodeId y, const Cursor& cursor);
    Mask decide(std::string_view predicate, const Value& a, const Value& b, const Type& type);
    template <class DecideLane>
    Value map_to_masks(const Type& type, const DecideLane& decide_lane);
    Value integer_arithmetic(MemoryState& state, std::string_view op, Cursor& cursor);
    Value combine_integers(std::string_view op, const Type& type, const Value& a, const Value& b);
    std::optional<Value> bit_operation(std::string_view op, const Type& type, const Value& a, const Value& b);
    Value fill_with_zeros(const Value& value, std::size_t size);
    std::optional<Value> join_parts(const Type& type, const Value& a, const Value& b);
    int combined_object(std::string_view op, const PossibleValue& x, const PossibleValue& y) const;
    Value convert(MemoryState& state, std::string_view op, Cursor& cursor);
    Value convert_lane(std::string_view op, const Value& value, const Type& source, const Type& target);
    Value integer_to_number(bool is_signed, const Value& value, const Type& source, const Type& target);
    Value truncate_integer(const Value& value, const Type& source, const Type& target);
    Value extend_integer(bool with_zeros, const Value& value, const Type& source, const Type& target);
    Value rearrange(MemoryState& state, std::string_view op, Cursor& cursor);
    Value extract_lane(MemoryState& state, const Type& type, const Value& vector, Cursor& cursor);
    Value shuffle(const Type& type, const Value& a, const Value& b, const Type& index_type, const Value& indices);
    std::optional<Value> run_call_instruction(MemoryState& state, Cursor& cursor);
    std::optional<Value> run_known_function(MemoryState& state, const std::string& name, const Type& type,
                                            const std::vector<Value>& arguments, const std::vector<const Type*>& types);
    std::optional<Value> run_number_function(const std::string& name, const Type& type,
                                             const std::vector<Value>& arguments);
    bool is_two(const Value& value) const;
    std::optional<Value> run_memory_function(MemoryState& state, const std::string& name,
                                             const std::vector<Value>& arguments,
                                             const std::vector<const Type*>& types);
    Value filled_bytes(const std::vector<PossibleValue>& byte, std::size_t n);
    std::optional<Value> run_llvm_function(const std::string& name, const Type& type,
                                           const std::vector<Value>& arguments, const std::vector<const Type*>& types);
    Value choose_by_comparison(std::string_view predicate, const Type& type, const Value& a, const Value& b);
    std::string read_callee(MemoryState& state, Cursor& cursor);
    std::vector<Value> read_arguments(MemoryState& state, Cursor& cursor, std::vector<const Type*>& types);
    template <class Act>
    Value map_lanes(const Type& type, const Act& act);

    // Places and names
    int place_of_line(std::string_view line, const CallFrame& frame);
    int place_in_ir(std::string_view line, int caller);
    int place_of_location(int location, int caller, int depth = 0);
    void name_value(int variable, const Value& value, std::size_t first_byte, int depth);
    std::string member_path(int variable, std::size_t offset) const;
    void handle_debug_record(MemoryState& state, std::string_view line, Cursor cursor, bool is_record);

    Module& module_;
    Nodes& nodes_;
    std::string user_folder_, ir_file_;
    std::vector<SourcePlace> places_;
    std::vector<StoredNumber> stored_;
    std::map<std::pair<int, int>, int> known_places_;
    std::map<std::string, int> global_objects_;     // index of the memory object of each global, by its name
    std::map<int, std::string> function_objects_;   // name of each function whose address is taken, by its object
    std::map<int, std::pair<int, int>> variables_;  // by object: the variable, and the depth of calls
    std::map<int, Value> global_memory_;            // contents of global constants
    int object_count_ = 1;                          // index 0 stands for an integer
    int depth_ = 0, nesting_ = 0;                   // depth of calls, and of nested constants
    std::size_t steps_ = 0;
};

// Parts that the files of `Walk` share: flags of instructions, integers of any width, and lanes of vectors.

inline constexpr std::size_t max_steps = 3'000'000;

inline void skip_flags(Cursor& cursor) {
    constexpr std::array flags{"nnan",     "ninf", "nsz",      "arcp",     "contract", "afn",
                               "reassoc",  "fast", "nuw",      "nsw",      "exact",    "disjoint",
                               "inbounds", "nneg", "samesign", "volatile", "nusw"};
    for (bool found_flag = true; found_flag;) {
        found_flag = false;
        for (const char* const flag : flags) found_flag = cursor.take(flag) || found_flag;
    }
}

/// The lowest `bits` bits of `x` as an integer of that width, sign-extended; 0 or 1 for i1.
inline std::int64_t wrap(std::uint64_t x, int bits) {
    if (bits == 1) return static_cast<std::int64_t>(x & 1);
    if (bits >= 64) return static_cast<std::int64_t>(x);
    return static_cast<std::int64_t>(x << (64 - bits)) >> (64 - bits);
}

inline std::uint64_t as_unsigned(std::int64_t x, int bits) {
    return bits >= 64 ? static_cast<std::uint64_t>(x)
                      : static_cast<std::uint64_t>(x) & ((std::uint64_t{1} << bits) - 1);
}

/// Result of an integer operation; empty for a division by zero and for a division that overflows.
inline std::optional<std::int64_t> integer_result(std::string_view op, std::int64_t a, std::int64_t b, int bits) {
    const std::uint64_t x = as_unsigned(a, bits), y = as_unsigned(b, bits);
    const bool shifts = y < static_cast<std::uint64_t>(bits);
    if (op == "add") return wrap(x + y, bits);
    if (op == "sub") return wrap(x - y, bits);
    if (op == "mul") return wrap(x * y, bits);
    if (op == "and") return wrap(x & y, bits);
    if (op == "or") return wrap(x | y, bits);
    if (op == "xor") return wrap(x ^ y, bits);

    // A shift by the whole width or more has no defined result; it gives 0 here.
    if (op == "shl") return shifts ? wrap(x << y, bits) : 0;
    if (op == "lshr") return shifts ? wrap(x >> y, bits) : 0;
    if (op == "ashr") return shifts ? wrap(static_cast<std::uint64_t>(a >> y), bits) : 0;

    if (b == 0 || (b == -1 && a == INT64_MIN)) return {};
    if (op == "udiv") return wrap(x / y, bits);
    if (op == "urem") return wrap(x % y, bits);
    if (op == "sdiv") return wrap(static_cast<std::uint64_t>(a / b), bits);
    if (op == "srem") return wrap(static_cast<std::uint64_t>(a % b), bits);
    return {};
}

inline bool comparison_holds(std::string_view predicate, std::int64_t a, std::int64_t b, int bits) {
    const std::uint64_t x = as_unsigned(a, bits), y = as_unsigned(b, bits);
    if (bits == 1) {  // the only bit is the sign
        a = -a;
        b = -b;
    }
    if (predicate == "eq") return a == b;
    if (predicate == "ne") return a != b;
    if (predicate == "slt") return a < b;
    if (predicate == "sle") return a <= b;
    if (predicate == "sgt") return a > b;
    if (predicate == "sge") return a >= b;
    if (predicate == "ult") return x < y;
    if (predicate == "ule") return x <= y;
    if (predicate == "ugt") return x > y;
    return x >= y;
}

inline constexpr std::array integer_operations{"add", "sub",  "mul",  "udiv", "sdiv", "urem", "srem",
                                               "shl", "lshr", "ashr", "and",  "or",   "xor"};

/// The name of a function in the source, for messages.
inline std::string source_name(const std::string& name) {
    if (name.starts_with("llvm.")) return name.substr(5, name.find('.', 5) - 5);
    return name;
}

/// Applies `act(type of a lane, offset)` to each lane of a vector, or to the type itself.
template <class Act>
Value Walk::map_lanes(const Type& type, const Act& act) {
    if (!type.is_vector) return act(type, 0);
    Value result;
    for (std::size_t k = 0; k < type.count; ++k) {
        std::size_t offset = 0;
        const Type& lane = *type.part(k, offset);
        write_bytes(result, offset, lane.size, act(lane, offset));
    }
    return result;
}

}  // namespace lostbits::intersect::function
