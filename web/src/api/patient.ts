// Repeats a request that a busy server refuses (503) after the time in `Retry-After`, a few times at most.

/** The greatest number of tries of one request. */
const MOST_TRIES = 8;
/** The longest wait, seconds. If the server asks for more, the reader is told at once. */
const MOST_WAIT_S = 10;

/** Works like `fetch`. The answer may still be a 503 if the server is busy for long or names no time. */
export async function patient(url: string, init: RequestInit = {}): Promise<Response> {
  for (let tries = 1; ; tries += 1) {
    const answer = await fetch(url, init);
    if (answer.status !== 503 || tries === MOST_TRIES) return answer;
    const wait_s = seconds(answer.headers.get("retry-after"));
    if (wait_s === null || wait_s > MOST_WAIT_S) return answer;
    void answer.body?.cancel();
    await pause(wait_s * 1000, init.signal ?? undefined);
  }
}

/** The wait in seconds, from either form of `Retry-After` (RFC 9110, section 10.2.3). `null` for any other text. */
function seconds(header: string | null): number | null {
  if (header === null) return null;
  if (/^\s*\d+\s*$/.test(header)) return Number(header);
  const date = Date.parse(header);
  return Number.isNaN(date) ? null : Math.max(0, (date - Date.now()) / 1000);
}

/** Waits. Rejects early with the signal's reason if the request is aborted. */
function pause(wait_ms: number, signal?: AbortSignal): Promise<void> {
  return new Promise((done, failed) => {
    const give = () => {
      clearTimeout(timer);
      failed(signal?.reason);
    };
    const timer = setTimeout(() => {
      signal?.removeEventListener("abort", give);
      done();
    }, wait_ms);
    if (signal?.aborted) give();
    else signal?.addEventListener("abort", give, { once: true });
  });
}
