#include <fcntl.h>
#include <unistd.h>

#include "fuzz/fuzz.hpp"
#include "intersect/doors/pipe.hpp"

namespace lostbits::fuzz {

/// What `plugin serve` is asked through a pipe: batches for two forms, one of which refuses.
void fuzz_requests(std::string_view bytes) {
    using intersect::doors::ForeignForm;
    static const std::vector<ForeignForm> forms = [] {
        std::vector<ForeignForm> two(2);
        two[0].answer = [](const lb_batch& batch) {
            for (std::size_t i = 0; i < batch.size; ++i) {
                static_cast<float*>(batch.near_far)[2 * i] = static_cast<const float*>(batch.rays)[6 * i + 5];
                batch.hit[i] = 1;
            }
        };
        two[1].contract.shape = Shape::box;
        two[1].contract.bits = 64;
        two[1].answer = [](const lb_batch& batch) {
            if (batch.ends == nullptr) throw EnvironmentError("a box: refuses");
            for (std::size_t i = 0; i < batch.size; ++i)
                static_cast<double*>(batch.near_far)[2 * i] = static_cast<const double*>(batch.rays)[6 * i + 5];
        };
        return two;
    }();
    const std::filesystem::path path = file_of(bytes);
    const int input = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    static const int output = open("/dev/null", O_WRONLY | O_CLOEXEC);
    static_cast<void>(intersect::doors::serve_pipe(forms, input, output));
    close(input);
}

}  // namespace lostbits::fuzz
