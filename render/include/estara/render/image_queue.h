// Writing pictures while the next one is rendered.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "estara/render/file_pattern.h"
#include "estara/render/film.h"

namespace estara {

/// A thread that writes films to files, in order. Rendering waits for it only when pending_bytes
/// are waiting, a bound of memory.
class ImageQueue {
public:
    static constexpr std::size_t pending_bytes = std::size_t{1} << 30;

    ImageQueue();
    /// Writes what is pending; errors nobody has asked for with finish() are lost.
    ~ImageQueue();
    ImageQueue(const ImageQueue&) = delete;
    ImageQueue& operator=(const ImageQueue&) = delete;

    /// A film to render into, with anything in it: memory of one that is written, if there is any.
    Film film(int width, int height, const Aovs& aovs);

    /// Hands over a film, to be written once in each pattern. Waits while others of pending_bytes
    /// (but at least one) wait or are being written.
    /// Throws what an earlier film's writing threw; nothing is written from then on.
    void push(Film film, int frame, const std::vector<FilePattern>& patterns);

    /// Waits until all is written; throws as push().
    void finish();

private:
    struct Job {
        Film film;
        int frame;
        std::vector<FilePattern> patterns;
    };
    void work();
    void write(const Job& job);
    void rethrow();

    std::mutex m_mutex;
    std::condition_variable m_changed;
    std::deque<Job> m_jobs;        ///< the first one is being written
    std::vector<Film> m_finished;  ///< for film()
    std::exception_ptr m_error;
    bool m_failed = false, m_stop = false;
    std::thread m_thread;
};

}  // namespace estara
