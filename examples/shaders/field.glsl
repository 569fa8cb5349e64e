// A distance field only: lostbits writes the usual loop around it. The sphere is that of the scene.
// lostbits: hit_eps=0.001 max_steps=64 max_dist=20

float map(vec3 p, vec4 sphere) {
    vec3 q = p - sphere.xyz;
    return sqrt(q.x * q.x + q.y * q.y + q.z * q.z) - sphere.w;
}
