// The protocol of a pipe of lostbits (docs/pipe.md), for a C++ program that intersects spheres in float.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace batches {

struct Batch {
    std::uint32_t count = 0, stride = 0;  // count of rays; numbers from one sphere to the next, 0: one for all
    std::vector<float> rays, spheres;     // origin and direction of each; centre and radius of each
    std::vector<float> near_far;          // out: two numbers per ray
    std::vector<unsigned char> hit;       // out: 1 for a hit
};

// Reads exactly `bytes` bytes. Ends the program at the end of the input.
inline void read(void* into, std::size_t bytes) {
    if (bytes > 0 && std::fread(into, 1, bytes, stdin) != bytes) std::exit(0);
}

inline void write(const void* from, std::size_t bytes) {
    if (bytes > 0 && std::fwrite(from, 1, bytes, stdout) != bytes) std::exit(1);
}

// Writes a refusal in place of the header, and ends the program. `whose` is `missing` if the machine lacks something,
// or `error` if the user made a mistake.
[[noreturn]] inline void refuse(const std::string& whose, std::string why) {
    for (char& c : why) c = c == '\n' || c == '\r' ? ' ' : c;
    std::printf("lostbits-pipe/1\n%s=%s\n\n", whose.c_str(), why.c_str());
    std::exit(whose == "error" ? 2 : 3);
}

// Writes an error in place of an answer, and ends the program.
[[noreturn]] inline void fail(const std::string& why) {
    const auto length = static_cast<std::uint32_t>(why.size());
    write("LBA1", 4);
    write(&length, sizeof length);
    write(why.data(), why.size());
    std::exit(3);
}

// Answers batches until the input ends. `header` has lines key=value; answer(batch) fills near_far and hit.
template <class Answer>
[[noreturn]] void serve(const std::string& header, const Answer& answer) {
    std::printf("lostbits-pipe/1\n%s\n", header.c_str());
    std::fflush(stdout);
    for (Batch batch;;) {
        std::uint32_t head[5];  // magic, form, rays, solids, ends
        read(head, sizeof head);
        batch.count = head[2];
        batch.stride = head[3] == 1 ? 0 : 4;
        std::vector<float> ends(head[4]);  // not used for spheres here
        batch.rays.resize(6UL * head[2]);
        batch.spheres.resize(4UL * head[3]);
        for (std::vector<float>* part : {&batch.rays, &ends, &batch.spheres})
            read(part->data(), part->size() * sizeof(float));
        batch.near_far.assign(2UL * head[2], 0);
        batch.hit.assign(head[2], 0);
        answer(batch);
        const std::uint32_t status = 0;
        write("LBA1", 4);
        write(&status, sizeof status);
        write(batch.near_far.data(), batch.near_far.size() * sizeof(float));
        write(batch.hit.data(), batch.hit.size());
        std::fflush(stdout);
    }
}

}  // namespace batches
