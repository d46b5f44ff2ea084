// Values over time, {time: [], name: []}.

/** Number of the last time that is not after `time`, -1 before the first. */
export function indexAt(times, time) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1; else high = middle;
  }
  return low - 1;
}

/** Value of a series at a time, null where it is not known. The first sample counts a little earlier, too. */
export function valueAt(series, name, time) {
  if (!series.time || !series[name]) return null;
  const index = indexAt(series.time, time + (time < series.time[0] ? 1 : 0));
  return index < 0 ? null : series[name][index];
}

/** Value between two samples of a series, null where it is not known. */
export function between(series, name, time) {
  const before = valueAt(series, name, time), next = before === null ? -1 : indexAt(series.time, time) + 1;
  if (next < 1 || next >= series.time.length || series[name][next] === null) return before;
  const begin = series.time[next - 1], length = series.time[next] - begin;
  return before + (length > 0 ? (time - begin) / length : 0) * (series[name][next] - before);
}
