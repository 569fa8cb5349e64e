#include "number/recorded.hpp"

#include "number/error.hpp"

namespace lostbits {

constinit thread_local Recorder* Recorder::current_ = nullptr;

void Recorder::refuse() {
    throw Error(Exit::internal, "a recorded number was used where nothing records: construct a Recorder first");
}

NodeId record(TapeOp op, NodeId a, NodeId b, NodeId c) { return Recorder::current().apply(op, {a, b, c}); }

}  // namespace lostbits
