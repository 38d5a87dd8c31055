!> A block on a compliant base without tension: its rotation q, clockwise (to +x), and how far it sinks, z.
!>
!> The base is a bed of springs and dashpots (Winkler), or one of each under both edges (the two models of Psycharis and
!> Jennings 1983). A place s of the base, to the right of the foot of the centre of mass, is pressed down by
!> w = z + s sin q. Where w is above zero it pushes back with k w + c w', or not at all where that would pull. The edge
!> to which the block leans does not slide: a base that is stiff enough gives the block that turns about its edges.
!>
!> The equation changes where an edge lifts or lands, and where its dashpot would pull: by signs, which a step keeps.
!> Integrals over the part of the base that presses are exact. A state begins with q [rad], z [m] and their rates.
module rocking_soft_base
   use common_kinds, only : wp, gravity, pi
   use common_status, only : status_ok, status_invalid_argument
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: soft_base, soft_base_new, base_contact, contact_of, soft_base_parameters
   public :: accelerations, direction, energies, find_restoring, lever, take_signs, settled, velocity, watched, decides

   !> Numbers of a block: mass [kg], inertia about its centre [kg m^2], height of the centre [m], distance of the left
   !> and of the right edge from its foot [m]; stiffness [N/m^2] and damping [N s/m^2] of the base per length; 1 where
   !> half of both stands under each edge, 0 for a bed; 1 for the linear form of slender blocks, 0 for the full one
   integer, parameter :: soft_base_parameters = 9

   !> The block and its base in one of their modes, by signs
   type :: soft_base
      real(wp) :: mass = 0.0_wp
      real(wp) :: inertia = 0.0_wp
      real(wp) :: height = 0.0_wp
      real(wp) :: place(2) = 0.0_wp      !! of the left and of the right edge, from the foot [m]
      real(wp) :: stiffness = 0.0_wp     !! per length [N/m^2], of an edge [N/m]
      real(wp) :: damping = 0.0_wp       !! per length [N s/m^2], of an edge [N s/m]
      logical :: edges = .false.
      logical :: linear = .false.
      real(wp) :: limit(2) = 0.0_wp      !! rotation to the left and to the right taken as collapse [rad]
      integer :: down(2) = 1             !! is the edge pressed (1) or lifted (-1)?
      integer :: push(2) = 1             !! does spring with dashpot push there (1), or would they pull (-1)?
      integer :: root = 1                !! does a bed push (1) or is it released (-1) where it lifts?
      integer :: side = 1                !! to which it leans
   end type soft_base

   !> What the base does to the block
   type :: base_contact
      real(wp) :: force = 0.0_wp     !! up [N]
      real(wp) :: moment = 0.0_wp    !! of it about the foot, over the cosine of q [N m]
      real(wp) :: stored = 0.0_wp    !! in the springs [J]
      real(wp) :: spent = 0.0_wp     !! power that the base takes up [W]
      real(wp) :: range(2) = 0.0_wp  !! that presses [m]
      real(wp) :: most = 0.0_wp      !! greatest pressure per length [N/m], or force of an edge [N]
   end type base_contact

contains

   !> Set up from the flat parameter list
   subroutine soft_base_new(parameters, body, status)
      real(wp), intent(in) :: parameters(:)  !! see soft_base_parameters
      type(soft_base), intent(out) :: body
      integer(c_int), intent(out) :: status
      real(wp) :: total
      status = status_invalid_argument
      if (size(parameters) /= soft_base_parameters) return
      if (any(parameters(1:6) <= 0.0_wp) .or. parameters(7) < 0.0_wp) return
      body%mass = parameters(1)
      body%inertia = parameters(2)
      body%height = parameters(3)
      body%place = [-parameters(4), parameters(5)]
      body%edges = parameters(8) > 0.5_wp
      body%linear = parameters(9) > 0.5_wp
      total = parameters(4) + parameters(5)
      body%stiffness = parameters(6) * merge(0.5_wp * total, 1.0_wp, body%edges)
      body%damping = parameters(7) * merge(0.5_wp * total, 1.0_wp, body%edges)
      body%limit = min(2.0_wp * atan2(abs(body%place), body%height), 0.5_wp * pi)
      status = status_ok
   end subroutine soft_base_new

   !> Sine and cosine of a rotation
   pure function direction(body, q) result(d)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: q  !! [rad]
      real(wp) :: d(2)
      d = [sin(q), cos(q)]
      if (body%linear) d = [q, 1.0_wp]
   end function direction

   !> How far both edges are pressed down [m], and how fast [m/s]
   pure function pressed(body, y) result(w)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: y(:)
      real(wp) :: w(2, 2)
      real(wp) :: d(2)
      d = direction(body, y(1))
      w(:, 1) = y(2) + body%place * d(1)
      w(:, 2) = y(4) + body%place * d(2) * y(3)
   end function pressed

   !> Where a line through its values at both edges is zero; the middle of the base where it has no slope [m]
   pure function zero_of(body, at_edges) result(s)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: at_edges(2)
      real(wp) :: s
      real(wp) :: rise
      rise = at_edges(2) - at_edges(1)
      s = 0.5_wp * sum(body%place)
      if (abs(rise) > tiny(1.0_wp)) s = body%place(1) - at_edges(1) * (body%place(2) - body%place(1)) / rise
   end function zero_of

   !> The contact in the present mode
   pure function contact_of(body, y) result(found)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: y(:)
      type(base_contact) :: found
      real(wp) :: w(2, 2), p(2), on(2), d(2), j(0:2)
      integer :: i
      d = direction(body, y(1))
      w = pressed(body, y)
      p = body%stiffness * w(:, 1) + body%damping * w(:, 2)
      if (body%edges) then
         do i = 1, 2
            if (body%down(i) < 0) cycle
            found%stored = found%stored + 0.5_wp * body%stiffness * w(i, 1)**2
            found%spent = found%spent - body%stiffness * w(i, 1) * w(i, 2)
            if (body%push(i) < 0) cycle
            found%force = found%force + p(i)
            found%moment = found%moment + p(i) * body%place(i)
            found%spent = found%spent + p(i) * w(i, 2)
            found%most = max(found%most, p(i))
         end do
         on = [merge(body%place(1), body%place(2), body%down(1) > 0 .and. body%push(1) > 0), &
            merge(body%place(2), body%place(1), body%down(2) > 0 .and. body%push(2) > 0)]
         found%range = merge(on, [0.0_wp, 0.0_wp], on(1) <= on(2))
         return
      end if
      ! what is pressed, in which the springs hold their energy
      on = body%place
      if (body%down(1) < 0) on(1) = zero_of(body, w(:, 1))
      if (body%down(2) < 0) on(2) = zero_of(body, w(:, 1))
      if (all(body%down < 0)) return
      j = integrals(on)
      found%stored = 0.5_wp * body%stiffness * (y(2)**2 * j(0) + 2.0_wp * y(2) * d(1) * j(1) + d(1)**2 * j(2))
      found%spent = -body%stiffness * product_over(j, y(2), d(1), y(4), d(2) * y(3))
      ! and what of it pushes
      on = pushing(body, w(:, 1), p, on)
      if (.not. on(1) < on(2)) return
      j = integrals(on)
      associate (p0 => body%stiffness * y(2) + body%damping * y(4), &
         p1 => body%stiffness * d(1) + body%damping * d(2) * y(3))
         found%force = p0 * j(0) + p1 * j(1)
         found%moment = p0 * j(1) + p1 * j(2)
         found%spent = found%spent + product_over(j, p0, p1, y(4), d(2) * y(3))
         found%most = max(p0 + p1 * on(1), p0 + p1 * on(2))
      end associate
      found%range = on
   end function contact_of

   !> Of the pressed part of a bed what pushes back
   pure function pushing(body, w, p, pressed_part) result(on)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: w(2)             !! pressed down at the edges [m]
      real(wp), intent(in) :: p(2)             !! spring and dashpot at the edges [N/m]
      real(wp), intent(in) :: pressed_part(2)  !! [m]
      real(wp) :: on(2)
      real(wp) :: s
      on = pressed_part
      if (all(body%push < 0)) on(2) = on(1)
      if (all(body%push < 0) .or. all(body%push > 0)) return
      s = zero_of(body, p)
      if (body%push(1) < 0) then
         ! both grow to the right: the later of both zeros; else the first
         if (body%down(1) < 0) then
            on(1) = merge(zero_of(body, w), s, body%root > 0)
         else if (body%down(2) < 0 .and. body%root < 0) then
            on(1) = on(2)
         else
            on(1) = s
         end if
      else
         if (body%down(2) < 0) then
            on(2) = merge(zero_of(body, w), s, body%root > 0)
         else if (body%down(1) < 0 .and. body%root < 0) then
            on(2) = on(1)
         else
            on(2) = s
         end if
      end if
   end function pushing

   !> Integrals of 1, s and s^2
   pure function integrals(on) result(j)
      real(wp), intent(in) :: on(2)
      real(wp) :: j(0:2)
      j = [on(2) - on(1), (on(2)**2 - on(1)**2) / 2.0_wp, (on(2)**3 - on(1)**3) / 3.0_wp]
   end function integrals

   !> Integral of (a0 + a1 s)(b0 + b1 s)
   pure function product_over(j, a0, a1, b0, b1) result(x)
      real(wp), intent(in) :: j(0:2)
      real(wp), intent(in) :: a0, a1, b0, b1
      real(wp) :: x
      x = a0 * b0 * j(0) + (a0 * b1 + a1 * b0) * j(1) + a1 * b1 * j(2)
   end function product_over

   !> Velocity of the centre to +x over the rate of q, and its change with q
   pure function lever(body, q) result(a)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: q
      real(wp) :: a(2)
      real(wp) :: edge
      edge = body%place(merge(2, 1, body%side > 0))
      a = [edge * sin(q) + body%height * cos(q), edge * cos(q) - body%height * sin(q)]
      if (body%linear) a = [body%height, 0.0_wp]
   end function lever

   !> Accelerations of q and z
   pure function accelerations(body, y, base, ground) result(a)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: y(:)
      type(base_contact), intent(in) :: base
      real(wp), intent(in) :: ground(2)  !! to +x and up [m/s^2]
      real(wp) :: a(2)
      real(wp) :: d(2), x(2), weight
      d = direction(body, y(1))
      x = lever(body, y(1))
      weight = merge(body%mass * (gravity + ground(2)), base%force, body%linear)
      a(1) = (weight * body%height * d(1) - d(2) * base%moment - body%mass * x(1) * (x(2) * y(3)**2 + ground(1))) &
         / (body%inertia + body%mass * x(1)**2)
      a(2) = gravity + ground(2) - base%force / body%mass
      if (.not. body%linear) a(2) = a(2) - body%height * (d(1) * a(1) + d(2) * y(3)**2)
   end function accelerations

   !> Velocity of the centre to +x and up [m/s]
   pure function velocity(body, y) result(u)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: y(:)
      real(wp) :: u(2)
      real(wp) :: d(2), x(2)
      d = direction(body, y(1))
      x = lever(body, y(1))
      u = [x(1) * y(3), -y(4) - body%height * d(1) * y(3)]
   end function velocity

   !> Kinetic energy, and potential energy with that of the springs [J]
   pure function energies(body, y, base) result(e)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: y(:)
      type(base_contact), intent(in) :: base
      real(wp) :: e(2)
      real(wp) :: d(2)
      d = direction(body, y(1))
      e(1) = 0.5_wp * body%inertia * y(3)**2
      if (body%linear) then
         e(1) = e(1) + 0.5_wp * body%mass * ((body%height * y(3))**2 + y(4)**2)
         e(2) = -body%mass * gravity * (y(2) + 0.5_wp * body%height * y(1)**2)
      else
         e(1) = e(1) + 0.5_wp * body%mass * sum(velocity(body, y)**2)
         e(2) = body%mass * gravity * (body%height * (d(2) - 1.0_wp) - y(2))
      end if
      e(2) = e(2) + base%stored
   end function energies

   !> How far it sinks where it is held at a rotation and free to sink under its weight [m]
   pure function settled(body, q) result(z)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: q  !! [rad]
      real(wp) :: z
      real(wp) :: d(2), at_edges(2), weight, deep
      d = direction(body, q)
      at_edges = d(1) * body%place
      weight = body%mass * gravity
      if (body%edges) then
         z = weight / body%stiffness - maxval(at_edges)
         if (z + minval(at_edges) > 0.0_wp) z = 0.5_wp * (weight / body%stiffness - sum(at_edges))
         return
      end if
      ! what presses is a triangle: stiffness deep^2 / (2 |d|) is the weight, until it reaches the other edge
      deep = sqrt(2.0_wp * weight * abs(d(1)) / body%stiffness)
      if (deep < maxval(at_edges) - minval(at_edges)) then
         z = deep - maxval(at_edges)
      else
         z = weight / (body%stiffness * (body%place(2) - body%place(1))) - 0.5_wp * sum(at_edges)
      end if
   end function settled

   !> The block at a rotation, free to sink: its energy, the least that it can have there, and the moment that turns it
   !> back from a rotation to +x, of its weight and the base
   pure subroutine find_restoring(body, q, sunk, energy, moment)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: q         !! [rad]
      real(wp), intent(out) :: sunk     !! [m]
      real(wp), intent(out) :: energy   !! of weight and springs [J]
      real(wp), intent(out) :: moment   !! [N m]
      type(soft_base) :: held
      type(base_contact) :: base
      real(wp) :: y(4), d(2)
      held = body
      sunk = settled(body, q)
      y = [q, sunk, 0.0_wp, 0.0_wp]
      call take_signs(held, y)
      base = contact_of(held, y)
      d = direction(body, q)
      energy = sum(energies(held, y, base))
      moment = d(2) * base%moment - d(1) * body%height * body%mass * gravity
   end subroutine find_restoring

   !> The values whose signs make the mode: both edges pressed, both pushing, the base where it lifts, the side [m]
   pure function watched(body, y) result(value)
      type(soft_base), intent(in) :: body
      real(wp), intent(in) :: y(:)
      real(wp) :: value(6)
      real(wp) :: w(2, 2), lag, share
      w = pressed(body, y)
      lag = body%damping / body%stiffness
      value(1:2) = w(:, 1)
      value(3:4) = w(:, 1) + lag * w(:, 2)
      value(5) = 0.0_wp
      if (abs(w(1, 1) - w(2, 1)) > tiny(1.0_wp)) then
         share = w(1, 1) / (w(1, 1) - w(2, 1))
         value(5) = lag * (w(1, 2) + share * (w(2, 2) - w(1, 2)))
      end if
      value(6) = y(1) * (body%place(2) - body%place(1))
   end function watched

   !> Which of the watched values decide in the present mode?
   pure function decides(body) result(mask)
      type(soft_base), intent(in) :: body
      logical :: mask(6)
      mask(1:2) = .true.
      mask(3:4) = merge(body%down > 0, spread(any(body%down > 0), 1, 2), body%edges)
      mask(5) = .not. body%edges .and. body%down(1) /= body%down(2) .and. body%damping > 0.0_wp
      mask(6) = .not. body%linear
   end function decides

   !> Take the signs of a state; a value of zero has come to its end
   pure subroutine take_signs(body, y)
      type(soft_base), intent(inout) :: body
      real(wp), intent(in) :: y(:)
      real(wp) :: value(6)
      integer :: signs(6)
      value = watched(body, y)
      signs = [body%down, body%push, body%root, body%side]
      where (abs(value) > 0.0_wp)
         signs = nint(sign(1.0_wp, value))
      else where
         signs = -signs
      end where
      body%down = signs(1:2)
      body%push = signs(3:4)
      body%root = merge(signs(5), 1, body%damping > 0.0_wp)
      body%side = signs(6)
   end subroutine take_signs

end module rocking_soft_base
