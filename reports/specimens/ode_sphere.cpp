// ODE 0.16.2 (double, as Debian builds it): dCollide of a ray and a sphere ends the program on finite numbers.
// ode/src/ray.cpp:239 asks k < 0 of a k that is NaN where squares overflow, and goes on to normalise NaN; and a sphere
// of radius 0, which dCreateSphere allows (sphere.cpp:52), has a contact whose normal has no length.
//   g++ ode_sphere.cpp -lode && ./a.out
#include <sys/wait.h>
#include <unistd.h>
#include <cstdio>
#include <cstdlib>

#include <ode/ode.h>

void show(const char* what, double radius, double z, double direction, const char* expected) {
    std::printf("%s: expected %s, got ", what, expected);
    std::fflush(stdout);
    int status = 0;
    if (const pid_t child = fork(); child != 0) {
        waitpid(child, &status, 0);
        if (WIFSIGNALED(status)) std::printf("the end of the program (signal %d)\n", WTERMSIG(status));
        return;
    }
    dInitODE2(0), dAllocateODEDataForThread(dAllocateMaskAll);
    const dGeomID ball = dCreateSphere(nullptr, radius), ray = dCreateRay(nullptr, 1e300);
    dGeomRaySet(ray, 0, 0, z, 0, 0, direction);
    dContactGeom contact;
    if (dCollide(ray, ball, 1, &contact, sizeof contact)) std::printf("depth %g\n", contact.depth);
    else std::printf("no contact\n");
    std::fflush(stdout), _exit(0);
}

int main() {
    show("radius 1, 4 away", 1, -4, 1, "depth 3");
    show("radius 0, 4 away", 0, -4, 1, "depth 4 or no contact");
    show("radius 1e155, 4e155 away", 1e155, -4e155, 1, "depth 3e155");
    show("radius 1, a direction of length 1e-310", 1, -4, 1e-310, "depth 3");
}
