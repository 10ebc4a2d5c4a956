// Names that would run as scripts were they not taken for text.
export const COLUMN = `gx</script><script>alert('column')</script>`;
export const GNSS = `<img src=x onerror=alert('gnss')>"&.csv`;
export const DRIVE = `<svg onload=alert('drive')>'&amp;.toml`;
export const MODEL = `</script><script>alert("model")</script><!--`;
