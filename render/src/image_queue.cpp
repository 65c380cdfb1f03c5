#include "estara/render/image_queue.h"

#include <algorithm>
#include <utility>

#include "estara/render/image_file.h"

namespace estara {

ImageQueue::ImageQueue() : m_thread([this] { work(); }) {}

ImageQueue::~ImageQueue() {
    {
        const std::lock_guard lock(m_mutex);
        m_stop = true;
    }
    m_changed.notify_all();
    m_thread.join();
}

// Called with the lock held.
void ImageQueue::rethrow() {
    if (m_error) std::rethrow_exception(std::exchange(m_error, nullptr));
}

Film ImageQueue::film(int width, int height, const Aovs& aovs) {
    {
        const std::lock_guard lock(m_mutex);
        if (!m_finished.empty()) {
            Film used = std::move(m_finished.back());
            m_finished.pop_back();
            if (used.width == width && used.height == height && used.aovs == aovs) return used;
        }
    }
    return {width, height, aovs};
}

void ImageQueue::push(Film film, int frame, const std::vector<FilePattern>& patterns) {
    std::unique_lock lock(m_mutex);
    const std::size_t most = std::max<std::size_t>(1, pending_bytes / film.bytes());
    m_changed.wait(lock, [&] { return m_jobs.size() < most; });
    rethrow();
    m_jobs.push_back({std::move(film), frame, patterns});
    lock.unlock();
    m_changed.notify_all();
}

void ImageQueue::finish() {
    std::unique_lock lock(m_mutex);
    m_changed.wait(lock, [&] { return m_jobs.empty(); });
    rethrow();
}

void ImageQueue::work() {
    std::unique_lock lock(m_mutex);
    for (;;) {
        m_changed.wait(lock, [&] { return m_stop || !m_jobs.empty(); });
        if (m_jobs.empty()) return;
        // Others only append, and a deque's elements stay where they are then.
        const Job& job = m_jobs.front();
        const bool failed = m_failed;
        lock.unlock();
        if (!failed) write(job);
        lock.lock();
        if (m_finished.empty()) m_finished.push_back(std::move(m_jobs.front().film));
        m_jobs.pop_front();
        m_changed.notify_all();
    }
}

void ImageQueue::write(const Job& job) {
    try {
        for (const FilePattern& pattern : job.patterns) {
            write_image(pattern.path(job.frame), pattern.format(), job.film);
        }
    } catch (...) {
        const std::lock_guard lock(m_mutex);
        m_error = std::current_exception();
        m_failed = true;
    }
}

}  // namespace estara
