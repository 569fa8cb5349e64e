// watch [--still LOOKS] [--processor SECONDS] COMMAND WORD…: runs a test, and ends it by its progress.
//
// A clock on the wall says nothing of a test on a machine that has other work. The test is ended, with all that it
// started, where
// - at 120 looks, a second apart, it had next to nothing to compute, nor waited for a processor or for a disk; or
// - it used more than an hour of processor, as a loop without an end does.
// The test gets a temporary folder of its own. What it leaves there is named and removed, and fails the test; processes
// that it leaves behind are ended. The exit status, or the signal, is that of COMMAND.
#include <dirent.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// A process as in /proc/PID/stat.
struct Process {
    pid_t pid = 0, parent = 0;
    char state = 'Z';
    long ticks = 0;  ///< of a processor, its own and those of its children that ended
    std::string name;
};

/// False if the process is gone.
bool read_process(const std::string& path, Process& process) {
    std::string line;
    std::ifstream file(path);
    if (!std::getline(file, line)) return false;
    const std::size_t open = line.find('('), close = line.rfind(')');  // a name may hold blanks and brackets
    if (open == std::string::npos || close == std::string::npos) return false;
    process.pid = std::atoi(line.c_str());
    process.name = line.substr(open + 1, close - open - 1);
    std::istringstream rest(line.substr(close + 1));
    rest >> process.state >> process.parent;
    std::string skipped;
    for (int field = 5; field <= 13; ++field) rest >> skipped;
    for (int field = 14; field <= 17; ++field) {
        long ticks = 0;
        rest >> ticks;
        process.ticks += ticks;
    }
    return true;
}

/// The names in a folder of /proc that are numbers.
std::vector<pid_t> numbers_in(const std::string& folder) {
    std::vector<pid_t> numbers;
    DIR* const open = opendir(folder.c_str());
    if (open == nullptr) return numbers;
    while (const dirent* const entry = readdir(open))
        if (const pid_t number = std::atoi(entry->d_name); number > 0) numbers.push_back(number);
    closedir(open);
    return numbers;
}

/// All processes that this process started, and their descendants.
std::vector<Process> descendants() {
    std::map<pid_t, Process> all;
    for (const pid_t pid : numbers_in("/proc")) {
        Process process;
        if (read_process("/proc/" + std::to_string(pid) + "/stat", process)) all[pid] = process;
    }
    std::vector<Process> found;
    for (const auto& [pid, process] : all) {
        pid_t above = process.parent;
        for (int steps = 0; above > 1 && above != getpid() && steps < 4096; ++steps) {
            const auto next = all.find(above);
            above = next == all.end() ? 0 : next->second.parent;
        }
        if (above == getpid()) found.push_back(process);
    }
    return found;
}

/// Seconds in which a thread ran or could have run: on a machine with other work it waits for a processor.
double seconds_wanted(const std::string& thread) {
    double ran = 0, waited = 0;
    std::ifstream(thread + "/schedstat") >> ran >> waited;
    return (ran + waited) * 1e-9;
}

/// Counts the looks at which nothing happened.
class Progress {
public:
    /// Looks; `ended_ticks` are those of children that this process has waited for.
    void look(const std::vector<Process>& processes, long ended_ticks) {
        const double before = processor_seconds();
        double wanted = 0;
        bool waits_for_disk = false;
        std::map<pid_t, double> threads;
        ticks_ = ended_ticks;
        for (const Process& process : processes) {
            ticks_ += process.ticks;
            const std::string tasks = "/proc/" + std::to_string(process.pid) + "/task/";
            for (const pid_t task : numbers_in(tasks)) {
                Process thread;
                const std::string path = tasks + std::to_string(task);
                waits_for_disk = waits_for_disk || (read_process(path + "/stat", thread) && thread.state == 'D');
                threads[task] = seconds_wanted(path);
                wanted += threads[task] - (threads_.contains(task) ? threads_[task] : 0);
            }
        }
        threads_ = std::move(threads);
        // A process that polls for an event uses some hundredths of a processor and makes no progress. If work and
        // waiting alternate, a tenth of work is enough.
        const bool worked = waits_for_disk || std::max(wanted, processor_seconds() - before) >= 0.3;
        still_ = worked ? std::max(0, still_ - 10) : still_ + 1;
    }
    [[nodiscard]] int still() const { return still_; }
    [[nodiscard]] double processor_seconds() const {
        return static_cast<double>(ticks_) / static_cast<double>(sysconf(_SC_CLK_TCK));
    }

private:
    int still_ = 0;
    long ticks_ = 0;
    std::map<pid_t, double> threads_;  ///< seconds wanted
};

void reap(pid_t test, int& status, bool& over, long& ended_ticks) {
    int of_one = 0;
    for (pid_t pid = 0; (pid = waitpid(-1, &of_one, WNOHANG)) > 0;)
        if (pid == test) status = of_one, over = true;
    Process self;
    ended_ticks = 0;
    if (!read_process("/proc/self/stat", self)) return;
    timespec own{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &own);
    ended_ticks =
        std::max(0L, self.ticks - static_cast<long>(static_cast<double>(own.tv_sec * 1000000000L + own.tv_nsec) * 1e-9 *
                                                    static_cast<double>(sysconf(_SC_CLK_TCK))));
}

/// Ends all processes that are left, and waits for them.
void end_all() {
    for (int tries = 0; tries < 1000; ++tries) {
        const std::vector<Process> left = descendants();
        if (left.empty()) return;
        for (const Process& process : left) kill(process.pid, SIGKILL);
        while (waitpid(-1, nullptr, WNOHANG) > 0) {}
        usleep(2000);
    }
}

void say(const std::string& text) {
    std::fprintf(stderr, "watch: %s\n", text.c_str());
    std::fflush(stderr);
}

std::string in_words(const std::vector<Process>& processes) {
    std::string words;
    for (const Process& process : processes)
        words += "\n  " + std::to_string(process.pid) + " " + process.state + " " + process.name;
    return words;
}

/// The test's own temporary folder: TMPDIR is its path while it runs.
class OwnFolder {
public:
    OwnFolder() {
        const char* const above = std::getenv("TMPDIR");
        path_ = std::string(above != nullptr && *above != '\0' ? above : "/tmp") + "/test-XXXXXX";
        if (mkdtemp(path_.data()) == nullptr) {
            say("no folder can be made beside " + path_ + ": " + std::strerror(errno));
            std::exit(1);
        }
        chmod(path_.c_str(), 0755);  // for tests that give up the rights of root
        setenv("TMPDIR", path_.c_str(), 1);
    }
    /// Removes the folder; returns the names of the files in it.
    [[nodiscard]] std::string remove() const {
        std::string names;
        std::error_code ignored;
        for (const auto& entry : fs::directory_iterator(path_, ignored))
            names += " " + entry.path().filename().string();
        fs::remove_all(path_, ignored);
        return names;
    }

private:
    std::string path_;
};

struct Limits {
    int still = 120;
    double processor = 3600;
};

/// Reason why the test must be ended; empty if the test may go on.
std::string fault_of(const Progress& progress, const Limits& limits) {
    if (progress.still() >= limits.still)
        return "no progress at " + std::to_string(progress.still()) + " looks, a second apart";
    if (progress.processor_seconds() >= limits.processor)
        return "more than " + std::to_string(static_cast<long>(limits.processor)) + " s of processor";
    return "";
}

sigset_t heard() {
    sigset_t set;
    sigemptyset(&set);
    for (const int signal : {SIGCHLD, SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
    return set;
}

/// Waits for a signal until the second is over; 0 if none came.
int wait_a_second(const sigset_t& set) {
    const timespec second{1, 0};
    const int signal = sigtimedwait(&set, nullptr, &second);
    return signal > 0 ? signal : 0;
}

pid_t start(char** words, const sigset_t& before) {
    const pid_t watch = getpid(), test = fork();
    if (test != 0) return test;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != watch) _exit(127);
    sigprocmask(SIG_SETMASK, &before, nullptr);
    execvp(words[0], words);
    say(std::string(words[0]) + ": " + std::strerror(errno));
    _exit(127);
}

/// Ends in the same way as the test.
[[noreturn]] void end_by(int signal) {
    ::signal(signal, SIG_DFL);
    sigset_t one;
    sigemptyset(&one);
    sigaddset(&one, signal);
    raise(signal);
    sigprocmask(SIG_UNBLOCK, &one, nullptr);
    _exit(128 + signal);
}

}  // namespace

int main(int count, char** words) {
    Limits limits;
    int at = 1;
    for (; at + 1 < count && std::strncmp(words[at], "--", 2) == 0; at += 2) {
        if (std::strcmp(words[at], "--still") == 0) limits.still = std::atoi(words[at + 1]);
        else if (std::strcmp(words[at], "--processor") == 0) limits.processor = std::atof(words[at + 1]);
        else break;
    }
    if (at >= count || limits.still < 1 || !(limits.processor > 0)) {
        say("usage: watch [--still LOOKS] [--processor SECONDS] COMMAND WORD…");
        return 2;
    }
    const OwnFolder folder;
    const sigset_t set = heard();
    sigset_t before;
    sigprocmask(SIG_BLOCK, &set, &before);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    const pid_t test = start(words + at, before);
    if (test < 0) {
        say(std::string("no process can be started: ") + std::strerror(errno));
        static_cast<void>(folder.remove());
        return 1;
    }

    Progress progress;
    int status = 0, end_signal = 0;
    bool over = false;
    long ended_ticks = 0;
    std::string fault;
    for (timespec last{}, now{}; !over && fault.empty() && end_signal == 0;) {
        const int signal = wait_a_second(set);
        if (signal != 0 && signal != SIGCHLD) end_signal = signal;
        reap(test, status, over, ended_ticks);
        clock_gettime(CLOCK_MONOTONIC, &now);
        if (over || (signal != 0 && now.tv_sec - last.tv_sec < 2)) continue;  // children that end are no second
        last = now;
        progress.look(descendants(), ended_ticks);
        fault = fault_of(progress, limits);
    }
    if (!fault.empty()) say("the test is ended: " + fault + "; it was:" + in_words(descendants()));
    // Processes that serve a test, such as a browser, may end a moment later than the test.
    for (int looks = 0; over && looks < 50 && !descendants().empty(); ++looks) {
        usleep(20000);
        reap(test, status, over, ended_ticks);
    }
    if (over && !descendants().empty()) say("the test left processes, which are ended:" + in_words(descendants()));
    end_all();
    const std::string left = folder.remove();
    if (!left.empty()) say("the test left in its temporary folder:" + left);
    if (end_signal != 0) end_by(end_signal);
    if (!fault.empty()) return 1;
    if (WIFSIGNALED(status)) end_by(WTERMSIG(status));
    return WEXITSTATUS(status) == 0 && !left.empty() ? 1 : WEXITSTATUS(status);
}
