!> The force at the corners of a contact: a spring that knows no tension, Coulomb friction on a shear spring in the
!> plane of the contact, and dashpots in parallel with both, taken implicitly: the law of the plane room with a
!> cone (dem/law.f90).
!>
!> With the normal n from body 1 to body 2, the gap g (negative where bodies overlap), the velocity u of body 2 relative
!> to body 1 at the corner and the area a that it carries:
!>
!>    N  = -k_n a g
!>    S += -k_s a u_t dt,   |S| <= mu N            S turns with the contact
!>    D  = -beta k a u                              in both directions
!>
!> on body 2, the opposite on body 1. Dry joints: no cohesion, no tension. The dashpots are implicit as in the plane:
!> D = -beta k a u* / (1 + beta k a dt w), with u* the velocity after the step without it and w that of a unit impulse.
module dem3_law
   use common_kinds, only : wp
   use dem3_bodies, only : body, cross
   use dem3_patch, only : most_points, patch
   implicit none
   private
   public :: joint_law, contact_point, contact_pair, act, elastic_energy

   type :: joint_law
      real(wp) :: normal_stiffness = 0.0_wp    !! [Pa/m]
      real(wp) :: shear_stiffness = 0.0_wp     !! [Pa/m]
      real(wp) :: friction = 0.0_wp            !! coefficient
      real(wp) :: damping = 0.0_wp             !! stiffness-proportional, beta [s]
   end type joint_law

   type :: contact_point
      real(wp) :: own(3) = 0.0_wp              !! place in the frame of the first body [m]
      real(wp) :: area = 0.0_wp                !! [m^2], as it closed
      real(wp) :: spring_n = 0.0_wp, dash_n = 0.0_wp       !! compression positive [N]
      real(wp) :: spring_s(3) = 0.0_wp, dash_s(3) = 0.0_wp !! on the second body [N]
   end type contact_point

   type :: contact_pair
      integer :: part(2) = 0
      integer :: law = 1
      integer :: points = 0
      real(wp) :: normal(3) = 0.0_wp
      type(contact_point) :: point(most_points)
      real(wp) :: friction_loss = 0.0_wp       !! [J]
      real(wp) :: damping_loss = 0.0_wp        !! [J]
      real(wp) :: support_work = 0.0_wp        !! [J]
   end type contact_pair

   !> Corners that lie nearer to one of the step before than this share of the root of its area are the same
   real(wp), parameter :: same = 0.5_wp

contains

   !> Forces of a pair at its present overlap, added to both bodies; predicted velocities follow
   pure subroutine act(law, kick, drift, found, a, b, pair)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! length of the velocity step [s]
      real(wp), intent(in) :: drift             !! length of the position step before [s]
      type(patch), intent(in) :: found
      type(body), intent(inout) :: a
      type(body), intent(inout) :: b
      type(contact_pair), intent(inout) :: pair
      type(contact_point) :: before(most_points)
      logical :: taken(most_points)
      integer :: i, k, old, count

      count = pair%points
      before(:count) = pair%point(:count)
      taken(:count) = .false.
      pair%points = 0
      do i = 1, found%points
         if (found%gap(i) >= 0.0_wp) cycle
         old = partner(matmul(found%at(:, i) - a%x, a%turn), before(:count), taken(:count), found%area(i))
         pair%points = pair%points + 1
         associate (point => pair%point(pair%points))
            if (old > 0) then
               taken(old) = .true.
               point = before(old)
            else
               point = contact_point()
               point%area = max(found%area(i), tiny(1.0_wp))
            end if
            point%own = matmul(found%at(:, i) - a%x, a%turn)
            call press(law, kick, drift, found%normal, found%at(:, i), found%gap(i), a, b, pair, point)
         end associate
      end do
      do k = 1, count   ! what their springs held is lost; the forces that bodies predict from go with them
         if (taken(k)) cycle
         pair%friction_loss = pair%friction_loss + 0.5_wp * dot_product(before(k)%spring_s, before(k)%spring_s) &
            / (law%shear_stiffness * before(k)%area)
         call release(kick, pair%normal, before(k), a, b)
      end do
      if (found%points > 0) pair%normal = found%normal
   end subroutine act

   !> The point of the step before that a corner is; 0 where it is new
   pure function partner(own, before, taken, area) result(old)
      real(wp), intent(in) :: own(3)            !! place in the frame of the first body [m]
      type(contact_point), intent(in) :: before(:)
      logical, intent(in) :: taken(:)
      real(wp), intent(in) :: area              !! [m^2]
      integer :: old
      integer :: k
      real(wp) :: away, nearest
      old = 0
      nearest = huge(1.0_wp)
      do k = 1, size(before)
         if (taken(k)) cycle
         away = norm2(own - before(k)%own)
         if (away > same * sqrt(max(area, before(k)%area)) .or. away >= nearest) cycle
         nearest = away
         old = k
      end do
   end function partner

   !> Forces of a closed corner: springs, the normal dashpot, then friction on the shear spring and its dashpot
   pure subroutine press(law, kick, drift, normal, at, gap, a, b, pair, point)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! [s]
      real(wp), intent(in) :: drift             !! [s]
      real(wp), intent(in) :: normal(3)
      real(wp), intent(in) :: at(3)             !! [m]
      real(wp), intent(in) :: gap               !! [m]
      type(body), intent(inout) :: a
      type(body), intent(inout) :: b
      type(contact_pair), intent(inout) :: pair
      type(contact_point), intent(inout) :: point
      real(wp) :: arm_a(3), arm_b(3), u(3), slip(3), star(3), trial(3), held(3), new(3), old(3), change(3)
      real(wp) :: stiff_n, stiff_s, viscous, w_n, w_t, along(3), bound, length, push_n, spring_n, dash_n

      arm_a = at - a%x
      arm_b = at - b%x
      stiff_n = law%normal_stiffness * point%area
      stiff_s = law%shear_stiffness * point%area
      old = (point%spring_n + point%dash_n) * normal + point%spring_s + point%dash_s
      ! Velocity over the position step before: it has moved the springs.
      u = b%v - a%v + cross(b%spin, arm_b) - cross(a%spin, arm_a)
      slip = u - dot_product(u, normal) * normal
      ! The shear spring turns into the present plane and keeps its force.
      held = point%spring_s - dot_product(point%spring_s, normal) * normal
      length = norm2(held)
      if (length > 0.0_wp) held = held * (norm2(point%spring_s) / length)
      trial = held - stiff_s * drift * slip
      spring_n = -stiff_n * gap
      ! Normal dashpot: the predicted velocity holds the old force of this corner, of the others what is decided by now.
      bound = law%friction * max(spring_n + point%dash_n, 0.0_wp)
      new = bounded(trial + point%dash_s, bound)
      change = (spring_n + point%dash_n) * normal + new - old
      star = b%p - a%p + cross(b%pspin, arm_b) - cross(a%pspin, arm_a) + kick * answer(change, arm_a, arm_b, a, b)
      w_n = dot_product(normal, answer(normal, arm_a, arm_b, a, b))
      viscous = law%damping * stiff_n
      dash_n = -viscous * (dot_product(star, normal) - kick * w_n * point%dash_n) / (1.0_wp + viscous * kick * w_n)
      push_n = max(spring_n + dash_n, 0.0_wp)
      dash_n = push_n - spring_n
      ! Shear, now that the normal force is known.
      change = push_n * normal + trial + point%dash_s - old
      star = b%p - a%p + cross(b%pspin, arm_b) - cross(a%pspin, arm_a) + kick * answer(change, arm_a, arm_b, a, b)
      star = star - dot_product(star, normal) * normal
      along = star
      length = norm2(along)
      bound = law%friction * push_n
      if (norm2(trial) >= bound) then
         new = bounded(trial, bound)
         ! Mean force over the step times the slip.
         pair%friction_loss = pair%friction_loss + 0.5_wp * dot_product(trial - new, held + new) / stiff_s
         point%spring_s = new
         held = 0.0_wp
      else
         held = 0.0_wp
         if (length > 0.0_wp) then
            along = along / length
            w_t = dot_product(along, answer(along, arm_a, arm_b, a, b))
            viscous = law%damping * stiff_s
            held = -viscous * (star - kick * w_t * point%dash_s) / (1.0_wp + viscous * kick * w_t)
         end if
         new = bounded(trial + held, bound)
         held = new - trial
         point%spring_s = trial
      end if
      pair%damping_loss = pair%damping_loss - 0.5_wp * drift * ((point%dash_n + dash_n) * dot_product(u, normal) &
         + dot_product(point%dash_s + held, u))
      point%dash_s = held
      point%spring_n = spring_n
      point%dash_n = dash_n
      new = push_n * normal + point%spring_s + point%dash_s
      if (a%fixed) pair%support_work = pair%support_work &
         + 0.5_wp * drift * dot_product(new + old, a%v + cross(a%spin, arm_a))
      if (b%fixed) pair%support_work = pair%support_work &
         - 0.5_wp * drift * dot_product(new + old, b%v + cross(b%spin, arm_b))
      call give(a, -new, -kick * (new - old), arm_a)
      call give(b, new, kick * (new - old), arm_b)
   end subroutine press

   !> A vector no longer than a bound
   pure function bounded(vector, bound) result(short)
      real(wp), intent(in) :: vector(3)
      real(wp), intent(in) :: bound
      real(wp) :: short(3)
      real(wp) :: length
      length = norm2(vector)
      short = vector
      if (length > bound) short = vector * (bound / length)
   end function bounded

   !> Velocity at a point that a unit of time of a force on body 2, and its opposite on body 1, gives
   pure function answer(force, arm_a, arm_b, a, b) result(u)
      real(wp), intent(in) :: force(3)          !! [N]
      real(wp), intent(in) :: arm_a(3)          !! [m]
      real(wp), intent(in) :: arm_b(3)
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      real(wp) :: u(3)
      u = (a%inverse_mass + b%inverse_mass) * force
      if (.not. a%fixed) u = u + cross(matmul(a%inverse, cross(arm_a, force)), arm_a)
      if (.not. b%fixed) u = u + cross(matmul(b%inverse, cross(arm_b, force)), arm_b)
   end function answer

   !> Add a force to a body, and its change to the body's predicted velocity
   pure subroutine give(b, force, impulse, arm)
      type(body), intent(inout) :: b
      real(wp), intent(in) :: force(3)          !! [N]
      real(wp), intent(in) :: impulse(3)        !! change of the force times the step [N s]
      real(wp), intent(in) :: arm(3)            !! [m]
      if (b%fixed) return
      b%force = b%force + force
      b%moment = b%moment + cross(arm, force)
      b%p = b%p + b%inverse_mass * impulse
      b%pspin = b%pspin + matmul(b%inverse, cross(arm, impulse))
   end subroutine give

   !> A corner that is no more: its old force leaves the predicted velocities
   pure subroutine release(kick, normal, point, a, b)
      real(wp), intent(in) :: kick              !! [s]
      real(wp), intent(in) :: normal(3)
      type(contact_point), intent(in) :: point
      type(body), intent(inout) :: a
      type(body), intent(inout) :: b
      real(wp) :: old(3), at(3)
      old = (point%spring_n + point%dash_n) * normal + point%spring_s + point%dash_s
      at = a%x + matmul(a%turn, point%own)
      call give(a, [0.0_wp, 0.0_wp, 0.0_wp], kick * old, at - a%x)
      call give(b, [0.0_wp, 0.0_wp, 0.0_wp], -kick * old, at - b%x)
   end subroutine release

   !> Energy in the springs of a pair [J]
   pure function elastic_energy(law, pair) result(energy)
      type(joint_law), intent(in) :: law
      type(contact_pair), intent(in) :: pair
      real(wp) :: energy
      integer :: k
      energy = 0.0_wp
      do k = 1, pair%points
         energy = energy + 0.5_wp * (pair%point(k)%spring_n**2 / law%normal_stiffness &
            + dot_product(pair%point(k)%spring_s, pair%point(k)%spring_s) / law%shear_stiffness) / pair%point(k)%area
      end do
   end function elastic_energy

end module dem3_law
