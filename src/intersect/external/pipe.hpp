// Any program, in any language, as an intersector: it reads batches on its standard input and answers on its standard
// output. docs/pipe.md describes the protocol.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "intersect/external/contract.hpp"
#include "intersect/process/stop_token.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {

/// Header of a batch, little-endian. The numbers of the batch follow in this order: 6 numbers of each ray; the
/// beginning of each ray, if the form has the flag `range`; the end of each ray, if rays have ends; the numbers of each
/// primitive.
struct PipeRequest {
    char magic[4] = {'L', 'B', 'Q', '1'};
    std::uint32_t form_index = 0;  ///< in the program's header, from 0
    std::uint32_t ray_count = 0;
    std::uint32_t primitive_count = 0;  ///< 1, or `ray_count`
    std::uint32_t end_count = 0;        ///< `ray_count`, or 0
};
static_assert(sizeof(PipeRequest) == 20);

/// Header of an answer. Near and far of every ray follow, then a byte `hit` for each ray. If `error_bytes` is not 0, an
/// error text of that many bytes follows instead.
struct PipeAnswer {
    char magic[4] = {'L', 'B', 'A', '1'};
    std::uint32_t error_bytes = 0;
};
static_assert(sizeof(PipeAnswer) == 8);

/// Bit in `error_bytes` that only processes of this program set. It says that the form changed the floating-point state
/// of the processor and did not restore it.
inline constexpr std::uint32_t state_changed_bit = 1U << 31;

/// Magic of a message that this program sends to another process of this program in place of a request. From then on
/// the columns of a batch and of its answer are in memory that both share (process/shared_memory.hpp); only the headers
/// go through the pipe.
inline constexpr char shared_memory_magic[4] = {'L', 'B', 'M', '1'};

/// Indices of the columns of a batch, in the order in which they go through the pipe: first the columns of the request,
/// then those of the answer.
struct BatchColumn {
    enum : std::size_t { rays, starts, ends, primitives, near_far, hit, count, request_columns = near_far };
};
/// Size of each column in bytes; 0 if the batch does not have the column.
using ColumnBytes = std::array<std::size_t, BatchColumn::count>;
ColumnBytes column_bytes(const PipeRequest& request, const Contract& contract);
/// Offset of each column in shared memory; the last entry is the end of the last column.
std::array<std::size_t, BatchColumn::count + 1> column_offsets(const ColumnBytes& bytes);

struct PipeOptions {
    double seconds = 30;              ///< limit for one answer
    unsigned max_processes = 1;       ///< at most one per thread; a single one for a form that says one_thread
    process::StopToken stop = {};     ///< stop request of the caller: ends every wait for an answer
    std::string message_prefix = {};  ///< begin of messages; empty: the command
    bool is_lostbits = false;         ///< true if the command is this program: error texts pass unchanged, and memory
                                      ///< is shared
};

/// Starts the command and reads its header. Throws InputError for an invalid header or a header that says `error=`;
/// EnvironmentError if the process does not answer, or says `missing=`. The processes end with the program.
std::vector<ForeignForm> open_pipe(const std::string& command, const PipeOptions& options);

/// Returns the text that is sent in place of a header: the lines of the error, which say why the program cannot serve.
std::string error_lines_of(const Error& error);

/// Serves a pipe: answers requests on `input` with these forms until the input ends. Returns false if a message on the
/// input is not a request. Throws EnvironmentError if an answer cannot be written while the other process still waits
/// for the answer.
bool serve_pipe(const std::vector<ForeignForm>& forms, int input, int output);

}  // namespace lostbits::intersect::external
