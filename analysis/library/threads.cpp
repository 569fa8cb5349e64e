// Ends the threads that calls share.
#include <tbb/global_control.h>

#include "analysis/library/handles.hpp"

using namespace lostbits;
using namespace lostbits::analysis::library;

extern "C" int lostbits_end_threads(lostbits_error* error) {
    return run_guarded(error, [] {
        tbb::task_scheduler_handle threads{tbb::attach{}};
        if (!tbb::finalize(threads, std::nothrow))
            throw EnvironmentError(
                "the threads are in use by a call, by a thread that called the library, or by other code; end those "
                "first");
        return ExitStatus::done;
    });
}
