// A library whose form is right, but which does to the program what ILL_MANNER names: an action and a time.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

namespace {

void crash() { std::raise(SIGSEGV); }
void leave() { _exit(0); }
void stay() {
    for (;;) pause();
}

void crash_in_a_thread() {
    std::thread(crash).detach();
    std::this_thread::sleep_for(std::chrono::seconds(5));
}

void close_from(int first) {
    for (int descriptor = first; descriptor < 1024; ++descriptor) close(descriptor);
}

/// No more bytes can be written, and no more files opened.
void lower_limits() {
    for (const auto limit : {RLIMIT_FSIZE, RLIMIT_NOFILE}) {
        rlimit now{};
        getrlimit(limit, &now);
        now.rlim_cur = 3;
        setrlimit(limit, &now);
    }
}

void make_copy(void (*then)()) {
    if (fork() == 0 && then != nullptr) then();
}

/// At most once per process: the action of that time.
void behave(const char* when) {
    static bool done = false;
    const char* const manner = std::getenv("ILL_MANNER");
    if (manner == nullptr || done) return;
    const std::string all = manner, prefix = std::string(when) + " ";
    if (all.rfind(prefix, 0) != 0) return;
    done = true;
    const std::string deed = all.substr(prefix.size());
    if (deed == "_exit") _exit(0);
    if (deed == "quick_exit") std::quick_exit(0);
    if (deed == "exit") std::exit(0);
    if (deed == "crash in a thread") crash_in_a_thread();
    if (deed == "crash at exit") std::atexit(crash);
    if (deed == "_exit at exit") std::atexit(leave);
    if (deed == "stay") stay();
    if (deed == "fork") make_copy(nullptr);
    if (deed == "fork and exit") make_copy([] { std::exit(0); });
    if (deed == "fork and stay") make_copy(stay);
    if (deed == "chdir" && chdir("/") != 0) std::abort();
    if (deed == "close") close(STDOUT_FILENO);
    if (deed == "close all") close_from(0);
    if (deed == "close files") close_from(3);
    if (deed == "stop") kill(getpid(), SIGSTOP);
    if (deed == "lower limits") lower_limits();
    if (deed == "umask") umask(0777);
    if (deed == "setenv") setenv("LOSTBITS_DATA", "/nowhere", 1);
    if (deed == "throw") throw 1;
    if (deed == "throw in a thread") std::thread([] { throw 1; }).join();
    if (deed == "fork and setsid")
        make_copy([] {
            setsid();
            stay();
        });
}

struct LoadTimeActions {
    LoadTimeActions() { behave("load"); }
    ~LoadTimeActions() { behave("unload"); }
} const loaded;

Answer<float> right(const Ray<float>& ray, const Sphere<float>& sphere) {
    behave("call");
    float a = 0, h = 0, c = -sphere.radius * sphere.radius;
    for (int k = 0; k < 3; ++k) {
        const float f = ray.origin[k] - sphere.centre[k];
        a += ray.direction[k] * ray.direction[k];
        h += f * ray.direction[k];
        c += f * f;
    }
    const float disc = h * h - a * c;
    if (!(disc >= 0)) return miss;
    return {(-h - __builtin_sqrtf(disc)) / a, (-h + __builtin_sqrtf(disc)) / a};
}

}  // namespace

LOSTBITS_FORMS(form<right>("ill.right").whole_line())
