// Both roots of a sphere, as most pictures on shader sites compute them. Returns vec2(-1) for a miss.

vec2 nearAndFar(vec3 ro, vec3 rd, vec4 ball) {
    vec3 f = ro - ball.xyz;
    float b = dot(f, rd);
    float disc = b * b - (dot(f, f) - ball.w * ball.w);
    if (disc < 0.0) return vec2(-1.0);
    float root = sqrt(disc);
    return vec2(-b - root, root - b);
}
