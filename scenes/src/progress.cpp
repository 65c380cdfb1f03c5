// How far a work has come, on stderr.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <mutex>

#include "estara/scenes/program.h"

namespace estara {

struct Progress::Impl {
    enum class Kind { bar, lines, nothing };

    Kind kind;
    std::string what;
    std::uint64_t total;
    Stopwatch watch;
    std::atomic<std::uint64_t> done{0};
    std::mutex mutex;         // guards what follows
    double last_shown = 0.0;  // seconds since the start
    std::uint64_t tenths_shown = 0;
    bool has_bar = false;

    double share() const { return total == 0 ? 1.0 : std::min(1.0, double(done) / double(total)); }

    static void print(const std::string& text) {
        std::fputs(text.c_str(), stderr);
        std::fflush(stderr);
    }

    void show() {
        const double now = watch.seconds();
        if (kind == Kind::bar && now - last_shown >= 0.1) show_bar(now);
        if (kind == Kind::lines && now - last_shown >= 1.0) show_line(now);
    }

    void show_bar(double now) {
        constexpr int width = 30;
        const double part = share();
        const int filled = int(part * width);
        std::string text = fmt::format("\r{} [{:#<{}}{:{}}] {:3.0f} %", what, "", filled, "",
                                       width - filled, 100.0 * part);
        if (part > 0.0) text += fmt::format(", {} left", format_seconds(now * (1.0 - part) / part));
        print(text + "\x1b[K");
        last_shown = now;
        has_bar = true;
    }

    void show_line(double now) {
        const std::uint64_t tenths = std::uint64_t(share() * 10.0);
        if (tenths <= tenths_shown || tenths >= 10) return;  // the end has its own line
        print(fmt::format("{}: {} %, {}\n", what, 10 * tenths, format_seconds(now)));
        tenths_shown = tenths;
        last_shown = now;
    }
};

Progress::Progress(ProgressStyle style, std::string what, std::uint64_t total)
    : m_impl(std::make_unique<Impl>()) {
    using Kind = Impl::Kind;
    const bool terminal = style == ProgressStyle::automatic && isatty(STDERR_FILENO) != 0;
    m_impl->kind = style == ProgressStyle::none ? Kind::nothing
                   : terminal                   ? Kind::bar
                                                : Kind::lines;
    m_impl->what = std::move(what);
    m_impl->total = total;
    if (m_impl->kind == Kind::lines) Impl::print(m_impl->what + "\n");
}

Progress::~Progress() {
    try {
        if (m_impl->has_bar) Impl::print("\r\x1b[K");
        const bool whole = m_impl->done >= m_impl->total;
        if (m_impl->kind == Impl::Kind::lines && whole) {
            Impl::print(fmt::format("{}: done in {}\n", m_impl->what,
                                    format_seconds(m_impl->watch.seconds())));
        }
    } catch (...) {  // no memory for a message: it is not worth more
    }
}

void Progress::advance(std::uint64_t amount) noexcept {
    m_impl->done += amount;
    if (m_impl->kind == Impl::Kind::nothing) return;
    const std::unique_lock lock(m_impl->mutex, std::try_to_lock);
    if (!lock) return;  // another thread is showing it
    try {
        m_impl->show();
    } catch (...) {  // no memory for a message: it is not worth more
    }
}

}  // namespace estara
