// The image module as a part of the fuzzer, which loads no modules: so the module is instrumented too.
#include "output/image/image.hpp"

extern "C" lostbits::output::image::ImageBackend* lostbits_image_backend();

namespace lostbits::output::image {

ImageBackend& image_backend() { return *lostbits_image_backend(); }

}  // namespace lostbits::output::image
