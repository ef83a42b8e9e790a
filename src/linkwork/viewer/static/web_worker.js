"use strict";(()=>{function*u(e){let t=new DataView(e),r=e.byteLength-22,n=t.getUint32(r+16,!0);for(let o=t.getUint16(r+10,!0);o>0;o-=1){let[i,l]=[t.getUint32(n+24,!0),t.getUint16(n+28,!0)],a=t.getUint32(n+42,!0),p=a+30+t.getUint16(a+26,!0)+t.getUint16(a+28,!0);yield{name:new TextDecoder().decode(new Uint8Array(e,n+46,l)),content:new Uint8Array(e,p,i)},n+=46+l+t.getUint16(n+30,!0)+t.getUint16(n+32,!0)}}var d="https://linkwork.invalid/",k="/lib/python3.13/site-packages",y=["python_stdlib.zip","site.zip"],w=3e3,S=`
from itertools import chain
from pathlib import Path

from linkwork_page import take, tell, turn
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk
from linkwork.viewer.live.bytecode import with_bytecode

STDLIB = Path("/lib/python313.zip")


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, pause)
begin, work = desk.begin, desk.work
steps = chain(
    with_bytecode(STDLIB, STDLIB, Path("/tmp/prepared-python_stdlib.zip")),
    with_bytecode(Path("/tmp/site.zip"), Path("${k}"), Path("/tmp/prepared-site.zip")),
)


def prepare():
    return next(steps, 0) is None
`,h=[],f=null,c=!1;self.onmessage=({data:e})=>{typeof e=="string"?(h.push(e),P()):F(e).catch(t=>self.postMessage({failed:String(t)}))};async function F({engine:e,files:t,fragment:r,kept:n,prepare:o}){m("Starting Python …"),self.fetch=s=>Promise.resolve(A(String(s),t));let i=await loadPyodide({indexURL:d,lockFileContents:e.lock,packageBaseUrl:d});m("Loading the solver …");for(let{name:s,content:v}of u(t["site.zip"])){let g=`${k}/${s}`;i.FS.mkdirTree(g.slice(0,g.lastIndexOf("/"))),i.FS.writeFile(g,v,{canOwn:!0})}o&&i.FS.writeFile("/tmp/site.zip",new Uint8Array(t["site.zip"]),{canOwn:!0});for(let s of Object.keys(t))delete t[s];let l=()=>h.splice(0);i.registerJsModule("linkwork_page",{take:l,tell:s=>self.postMessage(s),turn:b}),await i.runPythonAsync(S),m("Solving …");let[a,p]=[i.globals.get("begin"),i.globals.get("work")];a(r,n?.name??"",n?.saved??"",n?.text??""),f="Suspending"in WebAssembly?()=>p.callPromising():()=>Promise.resolve(p()),await P(),o&&U(i)}function U(e){let t=e.globals.get("prepare"),r=()=>{if(c)setTimeout(r,w);else if(t())setTimeout(r);else{let n=Object.fromEntries(y.map(o=>[o,e.FS.readFile(`/tmp/prepared-${o}`).buffer]));for(let o of y)e.FS.unlink(`/tmp/prepared-${o}`);e.FS.unlink("/tmp/site.zip"),self.postMessage({prepared:n},Object.values(n))}};setTimeout(r,w)}async function P(){if(!(c||f===null)){c=!0;try{for(;await f();)await b()}catch(e){self.postMessage({failed:String(e)})}c=!1}}function b(){return new Promise(e=>{let{port1:t,port2:r}=new MessageChannel;t.onmessage=()=>{t.close(),e()},r.postMessage(null)})}function A(e,t){let r=e.slice(d.length),n=r.endsWith(".wasm")?"application/wasm":"application/octet-stream",o=e.startsWith(d)?t[r]:void 0;return o?new Response(o,{headers:{"content-type":n}}):new Response(null,{status:404})}function m(e){self.postMessage({doing:e})}})();
