!> Steps without springs: rigid contacts that neither overlap nor pull, with Coulomb friction and Newton's restitution
!> (Moreau 1988, Jean 1999: "Moreau-Jean" time stepping).
!>
!> Velocities live at half steps, as in the steps with springs. From v(n-1/2) and the places x(n), the impulses of all
!> contacts in the step are found together (nonsmooth_impulses), such that no gap is negative at x(n+1):
!>
!>    g(x(n) + h v(n-1/2)) + h n.(v(n+1/2) - v(n-1/2)) >= 0,
!>
!> the gap at the place that the old velocity leads to, which knows how far corners have turned, and a linear step from
!> there. Motion that stays on its contacts is so followed to second order (the SHAKE of molecular dynamics: Ryckaert,
!> Ciccotti and Berendsen 1977); a contact that closes loses its parting velocity. With a rebound e a contact that
!> closes faster than gravity would in a few steps leaves with e times its speed instead. An overlap that is there
!> already is undone slowly.
!>
!> Quasi-static: every step starts from rest, so that nothing moves but what is moved or cannot stand, and time waits
!> until what moves has come to rest.
module dem_moreau
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem_bodies, only : body
   use dem_contacts, only : contact_pair, overlap, measure, choose_edges
   use dem_law, only : point_force, point_frame, frame_of, hand_over, relative
   use dem_model, only : block_model, finish, move, predict, prepare
   use nonsmooth_impulses, only : along_normal, along_tangent, impulse_effort, impulse_problem, problem_new, &
      problem_room, solve_impulses
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: advance_rigid, rigid_step

   real(wp), parameter :: natural = 0.002_wp       !! of the time in which a block falls by its own size
   real(wp), parameter :: unhurried = 0.1_wp       !! the same without inertia
   real(wp), parameter :: tolerance = 1.0e-5_wp    !! of the velocity that gravity gives in a step
   integer, parameter :: most_rounds = 200
   real(wp), parameter :: at_rest = 1.0e-4_wp      !! of that velocity
   integer, parameter :: most_waits = 5000
   real(wp), parameter :: recovery = 2.0_wp        !! steps of gravity: velocity at which overlaps are undone
   real(wp), parameter :: closed_angle = 1.0e-4_wp !! at which a joint is closed [rad]
   real(wp), parameter :: gentle = 5.0_wp          !! steps of gravity: slower contacts do not rebound

contains

   !> A step that resolves the motion of the smallest block [s]
   pure function rigid_step(model) result(step)
      type(block_model), intent(in) :: model
      real(wp) :: step
      step = merge(unhurried, natural, model%quasi_static) * sqrt(model%set%size / gravity_of(model))
   end function rigid_step

   pure function gravity_of(model) result(g)
      type(block_model), intent(in) :: model
      real(wp) :: g
      g = max(hypot(model%gravity(1), model%gravity(2)), 1.0e-3_wp)
   end function gravity_of

   !> Up to `count` steps; returns early where the contacts must be searched again
   subroutine advance_rigid(model, count, status)
      type(block_model), intent(inout) :: model
      integer, intent(in) :: count
      integer(c_int), intent(out) :: status
      integer :: n, k
      status = status_ok
      if (model%rigid%pairs /= model%contacts%pairs) call make_ready(model, status)
      do n = 1, count
         if (status /= status_ok) return
         call one_step(model)
         do k = 1, size(model%set%item)
            call move(model, model%set%item(k), model%stale)
         end do
         call finish(model)
         if (model%quasi_static) call wait_for_rest(model)
         if (model%stale) then
            model%rigid%pairs = -1
            return
         end if
      end do
   end subroutine advance_rigid

   !> Without inertia time stands still until all has come to rest, or fallen
   pure subroutine wait_for_rest(model)
      type(block_model), intent(inout) :: model
      real(wp) :: speed
      logical :: moves
      integer :: k
      speed = 0.0_wp
      do k = 1, size(model%set%item)
         associate (b => model%set%item(k))
            if (.not. b%fixed) speed = max(speed, abs(b%vx) + abs(b%vy) + b%radius * abs(b%spin))
         end associate
      end do
      moves = speed > at_rest * model%step * gravity_of(model)
      model%waits = merge(model%waits + 1, 0, &
         model%shaking .and. moves .and. model%waits < most_waits)
   end subroutine wait_for_rest

   !> Order of the unknowns and room for the contact points, after a search
   subroutine make_ready(model, status)
      type(block_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer, allocatable :: link(:, :)
      integer :: k, nodes, links, points, failed

      status = status_out_of_memory
      points = 2 * model%contacts%pairs
      associate (rigid => model%rigid)
         if (.not. allocated(rigid%node)) then
            allocate (rigid%node(size(model%set%item)), rigid%place(5, size(model%set%item)), stat=failed)
            if (failed /= 0) return
         end if
         allocate (link(2, model%contacts%pairs), stat=failed)
         if (failed /= 0) return
         if (allocated(rigid%point)) deallocate (rigid%point)
         allocate (rigid%point(2, model%contacts%pairs), stat=failed)
         if (failed /= 0) return
         nodes = 0
         do k = 1, size(model%set%item)
            rigid%node(k) = 0
            if (model%set%item(k)%fixed) cycle
            nodes = nodes + 1
            rigid%node(k) = nodes
         end do
         links = 0
         do k = 1, model%contacts%pairs
            associate (bodies => model%contacts%pair(k)%bodies)
               if (any(rigid%node(bodies) == 0)) cycle
               links = links + 1
               link(:, links) = rigid%node(bodies)
            end associate
         end do
         call problem_new(nodes, link(:, :links), rigid%problem, status)
         if (status == status_ok) call problem_room(rigid%problem, points, status)
         if (status /= status_ok) return
         do k = 1, size(model%set%item)
            if (rigid%node(k) == 0) cycle
            rigid%node(k) = rigid%problem%matrix%rank(rigid%node(k))
            associate (b => model%set%item(k), at => 3 * rigid%node(k))
               rigid%problem%mass(at - 2:at) = [b%mass, b%mass, b%inertia]
            end associate
         end do
         rigid%pairs = model%contacts%pairs
      end associate
   end subroutine make_ready

   !> Forces of all contacts in the next step, added to the bodies
   subroutine one_step(model)
      type(block_model), intent(inout) :: model
      type(impulse_effort) :: effort
      integer :: k

      call prepare(model)
      if (model%quasi_static) then
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) cycle
               b%vx = 0.0_wp
               b%vy = 0.0_wp
               b%spin = 0.0_wp
            end associate
         end do
      end if
      associate (rigid => model%rigid, problem => model%rigid%problem)
         do k = 1, size(model%set%item)
            call predict(model, model%set%item(k))
            associate (b => model%set%item(k))
               if (b%fixed) then
                  rigid%place(:, k) = led_to(b, model%step, [b%px, b%py, b%pspin])
                  cycle
               end if
               rigid%place(:, k) = led_to(b, model%step, [b%vx, b%vy, b%spin])
               problem%rate(3 * rigid%node(k) - 2:3 * rigid%node(k)) = [b%vx, b%vy, b%spin]
               b%px = b%vx + model%kick * model%pull(1)
               b%py = b%vy + model%kick * model%pull(2)
               b%pspin = b%spin
               problem%free(3 * rigid%node(k) - 2:3 * rigid%node(k)) = [b%px, b%py, b%pspin]
            end associate
         end do
         problem%points = 0
         do k = 1, model%contacts%pairs
            call gather(model, k)
         end do
         call solve_impulses(problem, tolerance * model%step * gravity_of(model), most_rounds, effort)
         rigid%steps = rigid%steps + 1
         rigid%factors = rigid%factors + effort%factors
         rigid%most_rounds = max(rigid%most_rounds, effort%rounds)
         if (.not. effort%converged) rigid%open_steps = rigid%open_steps + 1
         rigid%residual = max(rigid%residual, effort%residual / (model%step * gravity_of(model)))
         do k = 1, model%contacts%pairs
            call act_rigidly(model, model%contacts%pair(k), rigid%point(:, k))
         end do
      end associate
   end subroutine one_step

   !> Place to which a velocity leads: x, y, rotation, its cosine and sine
   pure function led_to(b, step, rate) result(at)
      type(body), intent(in) :: b
      real(wp), intent(in) :: step                  !! [s]
      real(wp), intent(in) :: rate(3)               !! [m/s, m/s, rad/s]
      real(wp) :: at(5)
      at(1:3) = [b%x, b%y, b%angle] + step * rate
      at(4:5) = [cos(at(3)), sin(at(3))]
   end function led_to

   !> The points of a pair that may press in this step, into the problem
   subroutine gather(model, k)
      type(block_model), intent(inout) :: model
      integer, intent(in) :: k
      type(overlap) :: now, next
      type(body) :: a_next, b_next
      type(point_frame) :: frame
      real(wp) :: distance, u_n, u_t, still_n, still_t
      integer :: i, n, side

      associate (pair => model%contacts%pair(k), rigid => model%rigid, problem => model%rigid%problem)
         rigid%point(:, k) = 0
         if (pair%careful) call choose_edges(model%set, model%contacts%skin, pair, distance)
         associate (a => model%set%item(pair%bodies(1)), b => model%set%item(pair%bodies(2)))
            call measure(pair, a, b, now)
            if (now%width <= 0.0_wp) return
            call place(rigid%place(:, pair%bodies(1)), a_next)
            call place(rigid%place(:, pair%bodies(2)), b_next)
            call measure(pair, a_next, b_next, next)
            do i = 1, 2
               if (min(now%gap(i), next%gap(i)) > model%contacts%skin) cycle
               frame = frame_of(now, i, a, b)
               n = problem%points + 1
               problem%points = n
               rigid%point(i, k) = n
               problem%node(:, n) = rigid%node(pair%bodies)
               problem%row(:, 1, along_normal, n) = [-frame%nx, -frame%ny, -frame%a_n]
               problem%row(:, 2, along_normal, n) = [frame%nx, frame%ny, frame%b_n]
               problem%row(:, 1, along_tangent, n) = [-frame%tx, -frame%ty, -frame%a_t]
               problem%row(:, 2, along_tangent, n) = [frame%tx, frame%ty, frame%b_t]
               ! Parting velocity over the last step, where supports move as in the next one
               u_n = 0.0_wp
               u_t = 0.0_wp
               still_n = 0.0_wp
               still_t = 0.0_wp
               do side = 1, 2
                  associate (c => model%set%item(pair%bodies(side)), row => problem%row(:, side, :, n))
                     if (c%fixed) then
                        still_n = still_n + sum(row(:, 1) * [c%px, c%py, c%pspin])
                        still_t = still_t + sum(row(:, 2) * [c%px, c%py, c%pspin])
                     else
                        u_n = u_n + sum(row(:, 1) * [c%vx, c%vy, c%spin])
                     end if
                  end associate
               end do
               problem%shift(along_normal, n) = still_n + parting(model, now%gap(i), next%gap(i), u_n + still_n)
               problem%shift(along_tangent, n) = still_t
               problem%friction(n) = model%law(pair%law)%friction
               problem%impulse(:, n) = model%kick * [pair%point(i)%spring_n, pair%point(i)%spring_s]
            end do
            call share_friction(pair, now, rigid%point(:, k), problem)
         end associate
      end associate
   end subroutine gather

   !> The two points of a closed joint lie on the line of its shear force: both slide alike, to the last digit
   pure subroutine share_friction(pair, now, point, problem)
      type(contact_pair), intent(in) :: pair
      type(overlap), intent(in) :: now
      integer, intent(in) :: point(2)
      type(impulse_problem), intent(inout) :: problem
      if (any(point == 0) .or. abs(now%gap(2) - now%gap(1)) > closed_angle * pair%incident_length) return
      problem%row(:, :, along_tangent, point(2)) = problem%row(:, :, along_tangent, point(1))
      problem%shift(along_tangent, point(2)) = problem%shift(along_tangent, point(1))
   end subroutine share_friction

   !> What is added to the parting velocity of a contact: what remains must not be negative [m/s]
   pure function parting(model, gap, next_gap, u_n) result(shift)
      type(block_model), intent(in) :: model
      real(wp), intent(in) :: gap                   !! at the start of the step [m]
      real(wp), intent(in) :: next_gap              !! at the place that the old velocities lead to [m]
      real(wp), intent(in) :: u_n                   !! parting velocity of the last step [m/s]
      real(wp) :: shift
      real(wp) :: speed
      speed = model%step * gravity_of(model)
      if (model%rigid%rebound > 0.0_wp .and. next_gap < 0.0_wp .and. u_n < -gentle * speed) then
         shift = model%rigid%rebound * u_n
         return
      end if
      shift = next_gap / model%step - u_n
      if (gap < -recovery * speed * model%step) shift = shift - gap / model%step - recovery * speed
   end function parting

   !> A body at another place, for `measure`
   pure subroutine place(at, b)
      real(wp), intent(in) :: at(5)                 !! x, y, rotation, its cosine and sine
      type(body), intent(out) :: b
      b%x = at(1)
      b%y = at(2)
      b%angle = at(3)
      b%c = at(4)
      b%s = at(5)
   end subroutine place

   !> The impulses of a pair as forces on its bodies, and what they took
   subroutine act_rigidly(model, pair, point)
      type(block_model), intent(inout) :: model
      type(contact_pair), intent(inout) :: pair
      integer, intent(in) :: point(2)               !! numbers of its points in the problem, 0 where they cannot press
      type(overlap) :: now
      type(point_frame) :: frame
      type(point_force) :: force
      real(wp) :: u_n, u_t
      integer :: i

      associate (problem => model%rigid%problem)
         associate (a => model%set%item(pair%bodies(1)), b => model%set%item(pair%bodies(2)))
            call measure(pair, a, b, now)
            do i = 1, 2
               force = point_force()
               if (point(i) > 0) then
                  force%normal = problem%impulse(along_normal, point(i)) / model%kick
                  force%shear = problem%impulse(along_tangent, point(i)) / model%kick
               end if
               associate (was => pair%point(i))
                  if (.not. (was%closed .or. force%normal > 0.0_wp .or. abs(force%shear) > 0.0_wp)) cycle
                  frame = frame_of(now, i, a, b)
                  call relative(frame, b%vx - a%vx, b%vy - a%vy, a%spin, b%spin, u_n, u_t)
                  was%damping_loss = was%damping_loss - 0.5_wp * model%drift * (was%spring_n + force%normal) * u_n
                  was%friction_loss = was%friction_loss - 0.5_wp * model%drift * (was%spring_s + force%shear) * u_t
                  call hand_over(model%kick, model%drift, frame, was, force, a, b, pair%support_work)
                  was%spring_n = force%normal
                  was%spring_s = force%shear
                  was%closed = force%normal > 0.0_wp .or. abs(force%shear) > 0.0_wp
               end associate
            end do
         end associate
      end associate
   end subroutine act_rigidly

end module dem_moreau
