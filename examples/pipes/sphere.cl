// A ray/sphere intersector in OpenCL C that also compiles as CUDA. It has the operations of sphere.half_b in the same
// order. opencl_sphere.cpp and cuda_sphere.cu run it behind a pipe. Replace `half_b` by your own function.
#ifdef __CUDACC__
#define FUNCTION __device__
#define KERNEL extern "C" __global__
#define GLOBAL
#define PLACE (blockIdx.x * blockDim.x + threadIdx.x)
#else
#define FUNCTION
#define KERNEL __kernel
#define GLOBAL __global
#define PLACE ((unsigned int)get_global_id(0))
#ifdef AS_WRITTEN  // so that a * b + c rounds twice; with CUDA, use nvcc -fmad=false
#pragma OPENCL FP_CONTRACT OFF
#endif
#endif

// ray: origin and direction; sphere: centre and radius. Writes near and far. Returns false for a miss.
FUNCTION bool half_b(const float* ray, const float* sphere, float* near_far) {
    float x = ray[0] - sphere[0], y = ray[1] - sphere[1], z = ray[2] - sphere[2];
    float a = ray[3] * ray[3] + ray[4] * ray[4] + ray[5] * ray[5];
    float h = x * ray[3] + y * ray[4] + z * ray[5];
    float c = x * x + y * y + z * z - sphere[3] * sphere[3];
    float disc = h * h - a * c;
    if (disc < 0) return false;
    float root = sqrt(disc);
    near_far[0] = (-h - root) / a;
    near_far[1] = (-h + root) / a;
    return true;
}

// stride: count of numbers from the sphere of one ray to that of the next, or 0 if all rays have the same sphere.
KERNEL void intersect(GLOBAL const float* rays, GLOBAL const float* spheres, unsigned int stride, unsigned int count,
                      GLOBAL float* near_far, GLOBAL unsigned char* hit) {
    unsigned int i = PLACE;
    if (i >= count) return;
    float ray[6], sphere[4], answer[2] = {0, 0};
    for (int k = 0; k < 6; ++k) ray[k] = rays[6 * i + k];
    for (int k = 0; k < 4; ++k) sphere[k] = spheres[stride * i + k];
    hit[i] = half_b(ray, sphere, answer);
    near_far[2 * i] = answer[0];
    near_far[2 * i + 1] = answer[1];
}
