// CUDA on the processor, one thread after the other, as far as examples/pipes/cuda_sphere.cu needs it. Its host program
// and the CUDA side of sphere.cl are tested without a card. It says nothing about how a card computes.
#pragma once

#include <cmath>
#include <cstdlib>
#include <cstring>

#define __CUDACC__
#define __device__
#define __global__
#define CUDART_VERSION 0

using std::sqrt;

struct dim3 {
    unsigned x;
    explicit dim3(unsigned along = 1) : x(along) {}
};
inline dim3 gridDim, blockIdx, blockDim, threadIdx;

enum cudaError_t { cudaSuccess, cudaErrorMemoryAllocation };
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost };

struct cudaDeviceProp {
    char name[32];
    int major, minor;
};

inline cudaError_t cudaGetDeviceCount(int* count) {
    *count = std::getenv("NO_CARD") == nullptr;
    return cudaSuccess;
}

inline cudaError_t cudaGetDeviceProperties(cudaDeviceProp* card, int) {
    std::strcpy(card->name, "a stand-in");
    return cudaSuccess;
}

inline const char* cudaGetErrorString(cudaError_t error) { return error == cudaSuccess ? "no error" : "out of memory"; }

inline cudaError_t cudaMalloc(void** at, std::size_t bytes) {
    *at = std::getenv("NO_MEMORY") != nullptr ? nullptr : std::malloc(bytes);
    return *at != nullptr ? cudaSuccess : cudaErrorMemoryAllocation;
}

inline cudaError_t cudaFree(void* at) {
    std::free(at);
    return cudaSuccess;
}

inline cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind) {
    std::memcpy(to, from, bytes);
    return cudaSuccess;
}

/// Runs a kernel with the arguments of `intersect` in sphere.cl.
inline cudaError_t cudaLaunchKernel(const void* kernel, dim3 blocks, dim3 threads, void** arguments, std::size_t, int) {
    using Kernel = void (*)(const float*, const float*, unsigned, unsigned, float*, unsigned char*);
    gridDim = blocks;
    blockDim = threads;
    for (blockIdx.x = 0; blockIdx.x < blocks.x; ++blockIdx.x) {
        for (threadIdx.x = 0; threadIdx.x < threads.x; ++threadIdx.x)
            reinterpret_cast<Kernel>(const_cast<void*>(kernel))(
                *static_cast<const float**>(arguments[0]), *static_cast<const float**>(arguments[1]),
                *static_cast<unsigned*>(arguments[2]), *static_cast<unsigned*>(arguments[3]),
                *static_cast<float**>(arguments[4]), *static_cast<unsigned char**>(arguments[5]));
    }
    return cudaSuccess;
}
