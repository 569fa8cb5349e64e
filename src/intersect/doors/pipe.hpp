// Any program, in any language, as an intersector: it reads batches on its standard input and answers on its standard
// output. What it says is in docs/pipe.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "intersect/doors/contract.hpp"
#include "intersect/process/stop_token.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::doors {

/// What comes before the numbers of a batch, little-endian. They follow as ray by ray 6, then, where rays end,
/// of a form that says range where each begins, and where each ends, then of each solid the numbers of its shape.
struct PipeRequest {
    char magic[4] = {'L', 'B', 'Q', '1'};
    std::uint32_t form = 0;  ///< which of the header's, from 0
    std::uint32_t rays = 0;
    std::uint32_t solids = 0;  ///< 1, or as many as rays
    std::uint32_t ends = 0;    ///< as many as rays, or 0
};
static_assert(sizeof(PipeRequest) == 20);

/// What comes before an answer: near and far of every ray, then a byte `hit` of each; or, where `error` is not 0, a
/// text of so many bytes.
struct PipeAnswer {
    char magic[4] = {'L', 'B', 'A', '1'};
    std::uint32_t error = 0;
};
static_assert(sizeof(PipeAnswer) == 8);

/// In `error` of a process of this program: the form changes how the processor computes and does not set it back.
inline constexpr std::uint32_t changes_state = 1U << 31;

/// In place of a request, to a process of this program: from then on the columns of a batch, and of its answer, stand
/// in memory that both share (process/shared_room.hpp), and only what comes before them goes through the pipe.
inline constexpr char shares_memory[4] = {'L', 'B', 'M', '1'};

/// The columns of a batch in the order in which they go through the pipe: those that ask, then those of the answer.
struct BatchColumn {
    enum : std::size_t { rays, starts, ends, solids, near_far, hit, count, asked = near_far };
};
/// Of each how many bytes; 0 where the batch has none.
using ColumnBytes = std::array<std::size_t, BatchColumn::count>;
ColumnBytes column_bytes(const PipeRequest& request, const Contract& contract);
/// Where each begins in memory that is shared; the last is where all end.
std::array<std::size_t, BatchColumn::count + 1> places_of(const ColumnBytes& bytes);

struct PipeTerms {
    double seconds = 30;           ///< that an answer may take
    unsigned processes = 1;        ///< at most, one a thread; one alone for a form that says one_thread
    process::StopToken stop = {};  ///< of who opens it: ends the wait for an answer, whoever asked
    std::string who = {};          ///< begins messages; empty: the command
    bool ours = false;  ///< the command is this program: its words of refusal stand as they are, and it shares memory
};

/// Starts the command and reads what it says of itself. InputError for a header that makes no sense or says `error=`,
/// EnvironmentError where the process does not speak, or says `missing=`. The processes end with the program.
std::vector<ForeignForm> open_pipe(const std::string& command, const PipeTerms& terms);

/// In place of a header: why the program cannot serve, line by line.
std::string refusal_of(const Error& error);

/// The other end: answers requests on `input` with these forms until it ends. False where what came was no request;
/// EnvironmentError where an answer cannot be written although somebody still asks.
bool serve_pipe(const std::vector<ForeignForm>& forms, int input, int output);

}  // namespace lostbits::intersect::doors
