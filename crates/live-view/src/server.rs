//! The HTTP server: the page, its events, and the stop.

use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode, Uri};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::sse::Sse;
use axum::response::{Html, IntoResponse as _, Response};
use axum::routing::{get, post};
use axum::{Extension, Router};
use futures_util::stream::unfold;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::TokioIo;
use hyper_util::service::TowerToHyperService;
use serde_json::{Value, json};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, watch};
use tokio::task::yield_now;
use tokio::time::{sleep, timeout};

use super::access::{Access, random_hex};
use super::events::{Alive, Follower, Message, Published, Slot, publish};
use super::places::{Holder, Place, Places};

/// Of pages without the control token; those with it have the places of their connections.
const MOST_STREAMS: usize = 16;
/// Connections that the system keeps until they are accepted.
pub(super) const BACKLOG: u32 = 1024;
/// The head of a request is complete, or refused and answered, within this time.
const HEAD: Duration = Duration::from_secs(1);
/// A connection over which nothing has gone for so long is closed.
const PATIENCE: Duration = Duration::from_secs(10);
/// How long the pages have to take their last event.
const FAREWELL: Duration = Duration::from_millis(100);
const ACCEPTED_AT_ONCE: usize = Holder::Nobody.places() / 8;
const ACCEPT_PAUSE: Duration = Duration::from_millis(5);
/// For the head of a request, and for what waits to be sent.
const BUFFER_BYTES: usize = 16 * 1024;
const MOST_HEADERS: usize = 64;

const HEADERS: [(HeaderName, &str); 5] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    ),
];

/// What the pages of one session are about, and what they may do.
pub(super) struct ShownSession {
    pub(super) access: Access,
    /// Tells a page that has connected again whether this is still the same session.
    pub(super) name: String,
    pub(super) title: String,
    pub(super) lane: Value,
    pub(super) stop: Box<dyn Fn() + Send + Sync>,
}

#[derive(Clone)]
struct Served {
    session: Arc<ShownSession>,
    published: watch::Receiver<Published>,
    streams: Arc<Semaphore>,
}

/// Serves until the control loop closes, and gives the pages the time to hear of it.
pub(super) async fn serve(
    listener: TcpListener,
    session: ShownSession,
    slot: Slot,
    messages: Receiver<Message>,
) {
    let (sender, published) = watch::channel(Published::default());
    let served = Served {
        session: Arc::new(session),
        published,
        streams: Arc::new(Semaphore::new(MOST_STREAMS)),
    };
    let places = Arc::new(Places::default());
    let accepting = tokio::spawn(accept(listener, served, Arc::clone(&places)));
    publish(&slot, &messages, &sender).await;
    accepting.abort();
    let _ = timeout(FAREWELL, places.until_empty()).await;
}

/// Never waits for a place. Newcomers are looked at long before so many others have come that they lose theirs.
async fn accept(listener: TcpListener, served: Served, places: Arc<Places>) {
    let session = Arc::clone(&served.session);
    let service = TowerToHyperService::new(router(served));
    for accepted in 1_usize.. {
        let Ok((stream, _)) = listener.accept().await else {
            places.evict_oldest();
            sleep(ACCEPT_PAUSE).await;
            continue;
        };
        let (place, evicted) = places.enter();
        let attending = attend(stream, service.clone(), Arc::clone(&session), place);
        tokio::spawn(async move {
            tokio::select! {
                () = attending => {}
                _ = evicted => {}
            }
        });
        if accepted.is_multiple_of(ACCEPTED_AT_ONCE) {
            yield_now().await;
        }
    }
}

/// One connection: one request and its answer, as long as the other side takes it.
async fn attend(
    stream: TcpStream,
    service: TowerToHyperService<Router>,
    session: Arc<ShownSession>,
    place: Place,
) {
    let _ = stream.set_nodelay(true);
    let alive = Alive::default();
    let answer = service_fn(|mut request: hyper::Request<Incoming>| {
        if let Some(holder) = session.holder(&request) {
            place.let_in(holder);
        }
        request.extensions_mut().insert(Arc::clone(&alive));
        service.call(request)
    });
    let connection = http1::Builder::new()
        .keep_alive(false)
        .max_buf_size(BUFFER_BYTES)
        .max_headers(MOST_HEADERS)
        .serve_connection(TokioIo::new(stream), answer);
    let mut connection = pin!(connection);
    if timeout(HEAD, connection.as_mut()).await.is_ok() || !place.is_inside() {
        return;
    }
    while timeout(PATIENCE, connection.as_mut()).await.is_err() {
        if !alive.swap(false, Ordering::Relaxed) {
            return;
        }
    }
}

impl ShownSession {
    /// Who asks; none if the request is refused.
    fn holder(&self, request: &hyper::Request<Incoming>) -> Option<Holder> {
        let (access, headers) = (&self.access, request.headers());
        if access
            .refusal(request.method(), request.uri(), headers)
            .is_some()
        {
            return None;
        }
        if access.may_stop(headers) || access.offers_stop(request.uri()) {
            return Some(Holder::Controller);
        }
        (request.method() != Method::POST).then_some(Holder::Reader)
    }
}

/// No handler takes a body, so that none is read.
fn router(served: Served) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/events", get(events))
        .route("/stop", post(stop))
        .method_not_allowed_fallback(|| async { StatusCode::NOT_FOUND })
        .layer(from_fn_with_state(served.clone(), guard))
        .with_state(served)
}

async fn guard(State(served): State<Served>, request: Request, next: Next) -> Response {
    let access = &served.session.access;
    let mut response = match access.refusal(request.method(), request.uri(), request.headers()) {
        Some(status @ StatusCode::UNAUTHORIZED) => {
            (status, [(header::WWW_AUTHENTICATE, "Bearer")]).into_response()
        }
        Some(status) => status.into_response(),
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    headers
        .entry(header::CONTENT_SECURITY_POLICY)
        .or_insert(HeaderValue::from_static("default-src 'none'"));
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

async fn page() -> Response {
    let Ok(nonce) = random_hex::<16>() else {
        return StatusCode::INTERNAL_SERVER_ERROR.into_response();
    };
    let policy = format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    let policy = [(header::CONTENT_SECURITY_POLICY, policy)];
    (policy, Html(report::live(&nonce))).into_response()
}

async fn events(
    State(served): State<Served>,
    Extension(alive): Extension<Alive>,
    uri: Uri,
) -> Response {
    let place = if served.session.access.offers_stop(&uri) {
        None
    } else {
        let Ok(place) = Arc::clone(&served.streams).try_acquire_owned() else {
            return StatusCode::SERVICE_UNAVAILABLE.into_response();
        };
        Some(place)
    };
    let hello = hello(&served.session, &uri);
    let follower = Follower::new(served.published, &hello, alive, place);
    Sse::new(unfold(follower, Follower::next)).into_response()
}

fn hello(session: &ShownSession, uri: &Uri) -> Value {
    json!({
        "session": session.name,
        "title": session.title,
        "lane": session.lane,
        "may_stop": session.access.offers_stop(uri),
    })
}

async fn stop(State(served): State<Served>, headers: HeaderMap) -> StatusCode {
    if !served.session.access.may_stop(&headers) {
        return StatusCode::FORBIDDEN;
    }
    (served.session.stop)();
    StatusCode::OK
}
