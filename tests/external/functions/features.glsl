// A sphere by what GLSL has: structures, matrices, arrays, loops, switch, swizzles, and built-in functions.
#version 430
#define SQUARE(x) ((x) * (x)) /* a macro */
#define LONG(x) \
    (x + 1.0)

struct Ray { vec3 o, d; };
const float weights[3] = float[](0.5, 0.25, 0.25);
float shift = 0.125;  // set before main runs
uniform float time;

void turn(inout vec3 v, const mat3 m) { v = m * v; }

float kind(int k, float x) {
    switch (k) {
        case 0: return x;
        case 1: x += 1.0;
        case 2: return x * 2.0;
        default: break;
    }
    return abs(x) + sign(x);
}

// lostbits: direction=unit
float odd(vec3 ro, vec3 rd, vec4 ball) {
    precise Ray ray = Ray(ro - ball.xyz, rd);
    turn(ray.o, mat3(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0));
    turn(ray.d, mat3(0, 1, 0, 0, 0, 1, 1, 0, 0));
    precise float sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += weights[i] * ray.o[i];
    bvec3 near = lessThan(abs(ray.o), vec3(0.5));
    precise float extra = kind(any(near) ? all(near) ? 2 : 1 : 0, sum) + kind(3, shift) + LONG(sum);
    extra = mix(extra, clamp(sum, -1.0, 1.0), step(0.0, sum)) + length(ray.o.xz) + distance(ro.xy, rd.yx);
    extra += dot(reflect(ray.o, ray.d), vec3(1.0)) + smoothstep(0.0, 1.0, sum) + (transpose(mat2(1, 2, 3, 4)) * rd.zy).y;
    ray.d.zx = ray.d.zx;
    precise float a = dot(ray.d, ray.d), b = dot(ray.o, ray.d), c = dot(ray.o, ray.o) - SQUARE(ball.w);
    precise float disc = SQUARE(b) - a * c;
    if (disc < 0.0) return -1.0;
    precise float answer = (-b - sqrt(disc)) / a + 0.001 * max(extra, -extra);
    return answer;
}

float wave(vec3 ro, vec3 rd, vec4 ball) { return dot(ro, rd) +
    sin(ball.x); }
float timed(vec3 ro, vec3 rd, vec4 ball) { return dot(ro, rd) - ball.w + time; }
float endless(vec3 ro, vec3 rd, vec4 ball) {
    float t = 0.0;
    while (t < 100.0)
        t += distance(ro + t * rd, ball.xyz) - ball.w;
    return t;
}
float rounded(vec3 ro, vec3 rd, vec4 ball) { return float(int(ro.x)) + rd.x + ball.w; }
float whole(vec3 ro, vec3 rd, vec4 ball) {
    vec3 cell = floor(ro), part = fract(ro * 4.0);
    return dot(cell, rd) + ceil(rd.x) + trunc(part.y * 8.0) + roundEven(rd.y * 4.0) + mod(ro.z, 0.75) + ball.w;
}
#line 1000
float many(vec3 ro, vec3 rd, vec4 ball) { return dot(ro, rd) - ball.w; }
float many(vec3 ro, vec3 rd, vec3 ball, float r) { return dot(ro - ball, rd) + r; }

void main() { gl_FragColor = vec4(time); }
