!> What a run of blocks of the plane is made of: the hooks of dem_simulation.
module dem_plane_run
   use common_kinds, only : wp
   use common_lists, only : stop_end => dem_stop_end, stop_collapse => dem_stop_collapse, &
      stop_left => dem_stop_left, stop_overlap => dem_stop_overlap
   use common_status, only : status_ok, status_invalid_argument, status_not_finite, status_out_of_memory
   use dem_bodies, only : body, body_set, load_potential
   use dem_contacts, only : contact_pair, contact_set, overlap, measure_overlap, pair_loss
   use dem_energy, only : energy_terms
   use dem_jointed, only : jointed_model
   use dem_places, only : add_force, count_places, place_table
   use dem_law, only : elastic_energy
   use dem_model, only : block_model, advance_model, critical_step, finish_step, move_body
   use dem_moreau, only : greatest_speed, number_model_unknowns => number_unknowns, &
      solve_model_contacts => solve_contacts
   use dem_simulation, only : simulation, model_sizes, slides_not
   use dem_search, only : search_pairs
   use dem_tape, only : tape
   use dem_ties, only : forget_tie_losses, tie_dash_loss, tie_energy, tie_loss
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: block_simulation

   type, extends(simulation) :: block_simulation
      type(block_model) :: model
      real(wp) :: domain(4) = 0.0_wp         !! left, right, bottom, top of the scene [m]
   contains
      procedure :: get_model
      procedure :: find_pairs
      procedure :: find_critical_step
      procedure :: advance_springs
      procedure :: number_unknowns
      procedure :: solve_contacts
      procedure :: move_bodies
      procedure :: measure_energy
      procedure :: measure_agitation
      procedure :: measure_speed
      procedure :: measure_unbalance
      procedure :: find_least_balanced
      procedure :: find_fastest
      procedure :: check_limits
      procedure :: mark_rest
      procedure :: stop_bodies
      procedure :: forget_settling
      procedure :: record_state
      procedure :: list_sizes
      procedure :: allocate_state
      procedure :: walk_state
   end type block_simulation

contains

   function get_model(run) result(model)
      class(block_simulation), intent(inout), target :: run
      class(jointed_model), pointer :: model
      model => run%model
   end function get_model

   subroutine find_pairs(run, first_time, status)
      class(block_simulation), intent(inout) :: run
      logical, intent(in) :: first_time
      integer(c_int), intent(out) :: status
      associate (model => run%model)
         status = status_not_finite
         if (.not. all(abs(model%set%item%x) + abs(model%set%item%y) <= huge(1.0_wp))) return
         if (first_time) model%contacts%skin = 0.02_wp * model%set%size
         call search_pairs(model%set, model%contacts, first_time, status)
         run%record%pairs = model%contacts%pairs
      end associate
      if (first_time .and. status == status_ok) call refuse_overlaps(run)
   end subroutine find_pairs

   subroutine find_critical_step(run, step, status)
      class(block_simulation), intent(inout) :: run
      real(wp), intent(out) :: step             !! [s]
      integer(c_int), intent(out) :: status
      call critical_step(run%model, step, status)
   end subroutine find_critical_step

   subroutine advance_springs(run, count, threads, status)
      class(block_simulation), intent(inout) :: run
      integer, intent(in) :: count
      integer, intent(in) :: threads
      integer(c_int), intent(out) :: status
      call advance_model(run%model, count, threads)
      status = status_ok
   end subroutine advance_springs

   subroutine number_unknowns(run, status)
      class(block_simulation), intent(inout) :: run
      integer(c_int), intent(out) :: status
      call number_model_unknowns(run%model, status)
   end subroutine number_unknowns

   subroutine solve_contacts(run, status)
      class(block_simulation), intent(inout) :: run
      integer(c_int), intent(out) :: status
      call solve_model_contacts(run%model, status)
   end subroutine solve_contacts

   subroutine move_bodies(run)
      class(block_simulation), intent(inout) :: run
      integer :: k
      do k = 1, size(run%model%set%item)
         call move_body(run%model, run%model%set%item(k), run%model%stale)
      end do
      call finish_step(run%model)
   end subroutine move_bodies

   !> Energy balance at the time of the last forces
   function measure_energy(run) result(now)
      class(block_simulation), intent(in) :: run
      type(energy_terms) :: now
      integer :: k
      real(wp) :: vx, vy, spin, ax, ay, turn, cut, span, lost(2)

      associate (model => run%model)
         ! The first step takes half a kick from the initial velocity; steps never grow after it.
         span = max(model%kick, model%step)
         cut = 0.5_wp * model%mass_damping * span
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) cycle
               ax = b%fx * b%inverse_mass + model%pull(1)
               ay = b%fy * b%inverse_mass + model%pull(2)
               turn = b%moment * b%inverse_inertia
               vx = (b%vx * (1.0_wp + cut) - span * ax) / (1.0_wp - cut)
               vy = (b%vy * (1.0_wp + cut) - span * ay) / (1.0_wp - cut)
               spin = (b%spin * (1.0_wp + cut) - span * turn) / (1.0_wp - cut)
               now%leapfrog = now%leapfrog + 0.5_wp * (b%mass * (b%vx * vx + b%vy * vy) + b%inertia * b%spin * spin)
               now%kinetic = now%kinetic + 0.125_wp * (b%mass * ((b%vx + vx - 2.0_wp * model%base(1))**2 &
                  + (b%vy + vy - 2.0_wp * model%base(2))**2) + b%inertia * (b%spin + spin)**2)
               now%potential = now%potential - b%mass * (model%gravity(1) * (b%x - model%drift * b%vx - b%rest_x) &
                  + model%gravity(2) * (b%y - model%drift * b%vy - b%rest_y)) &
                  + load_potential(b, b%x - model%drift * b%vx, b%y - model%drift * b%vy, b%angle - model%drift * b%spin)
               now%mass_damping = now%mass_damping + b%mass_loss
               now%work = now%work + b%work
            end associate
         end do
         now%friction = model%contacts%friction_loss + tie_loss(model%ties)
         now%elastic = tie_energy(model%ties)
         now%damping = model%contacts%damping_loss + tie_dash_loss(model%ties)
         now%work = now%work + model%contacts%support_work + model%ties%support_work
         do k = 1, model%contacts%pairs
            associate (pair => model%contacts%pair(k))
               if (.not. model%rigid%setting%used) now%elastic = now%elastic + elastic_energy(model%law(pair%law), pair)
               lost = pair_loss(pair)
               now%friction = now%friction + lost(1)
               now%damping = now%damping + lost(2)
               now%work = now%work + pair%support_work
            end associate
         end do
      end associate
   end function measure_energy

   !> Twice the kinetic energy of the half step [J]
   function measure_agitation(run) result(energy)
      class(block_simulation), intent(in) :: run
      real(wp) :: energy
      associate (b => run%model%set%item)
         energy = sum(b%mass * (b%vx**2 + b%vy**2) + b%inertia * b%spin**2)
      end associate
   end function measure_agitation

   !> Greatest speed of a body [m/s]
   function measure_speed(run) result(speed)
      class(block_simulation), intent(in) :: run
      real(wp) :: speed
      speed = greatest_speed(run%model)
   end function measure_speed

   !> Greatest unbalanced force over weight, and moment over weight times radius
   function measure_unbalance(run) result(ratio)
      class(block_simulation), intent(in) :: run
      real(wp) :: ratio
      real(wp) :: g
      integer :: k
      associate (model => run%model)
         g = max(hypot(model%gravity(1), model%gravity(2)), 1.0e-3_wp)
         ratio = 0.0_wp
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) cycle
               ratio = max(ratio, abs(b%fx / b%mass + model%gravity(1)) / g, &
                  abs(b%fy / b%mass + model%gravity(2)) / g, abs(b%moment) / (b%mass * g * b%radius))
            end associate
         end do
      end associate
   end function measure_unbalance

   function find_least_balanced(run) result(number)
      class(block_simulation), intent(in) :: run
      integer :: number
      associate (b => run%model%set%item)
         number = maxloc(abs(b%fx * b%inverse_mass) + abs(b%fy * b%inverse_mass + run%model%gravity(2)), &
            mask=.not. b%fixed, dim=1)
      end associate
   end function find_least_balanced

   function find_fastest(run) result(number)
      class(block_simulation), intent(in) :: run
      integer :: number
      associate (b => run%model%set%item)
         number = maxloc(b%vx**2 + b%vy**2, mask=.not. b%fixed, dim=1)
      end associate
   end function find_fastest

   !> Has a body collapsed or left the domain?
   subroutine check_limits(run, collapse)
      class(block_simulation), intent(inout) :: run
      real(wp), intent(in) :: collapse
      integer :: k
      real(wp) :: x, y
      logical :: gone
      associate (model => run%model, record => run%record, domain => run%domain)
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) cycle
               x = b%x - model%base_place(1)
               y = b%y - model%base_place(2)
               gone = collapse > 0.0_wp .and. hypot(x - b%rest_x, y - b%rest_y) > collapse
               if (gone .and. model%shaking) gone = slides_not(run%options, abs(b%angle - b%rest_angle), b%rest_y - y)
               if (gone) record%reason = stop_collapse
               if (x < domain(1) .or. x > domain(2) .or. y < domain(3) .or. y > domain(4)) record%reason = stop_left
               if (record%reason == stop_end) cycle
               record%blamed(1) = k
               return
            end associate
         end do
      end associate
   end subroutine check_limits

   !> Bodies that overlap deeper than half the skin were drawn so
   subroutine refuse_overlaps(run)
      class(block_simulation), intent(inout) :: run
      integer :: k
      type(overlap) :: now
      associate (set => run%model%set, contacts => run%model%contacts)
         do k = 1, contacts%pairs
            associate (pair => contacts%pair(k))
               call measure_overlap(pair, set%item(pair%bodies(1)), set%item(pair%bodies(2)), now)
               if (now%width <= 0.5_wp * contacts%skin .or. maxval(now%gap) > -0.5_wp * contacts%skin) cycle
               run%record%reason = stop_overlap
               run%record%blamed = pair%bodies
               return
            end associate
         end do
      end associate
   end subroutine refuse_overlaps

   subroutine mark_rest(run)
      class(block_simulation), intent(inout) :: run
      associate (b => run%model%set%item)
         b%rest_x = b%x
         b%rest_y = b%y
         b%rest_angle = b%angle
      end associate
   end subroutine mark_rest

   subroutine stop_bodies(run)
      class(block_simulation), intent(inout) :: run
      associate (b => run%model%set%item)
         b%vx = 0.0_wp
         b%vy = 0.0_wp
         b%spin = 0.0_wp
      end associate
   end subroutine stop_bodies

   subroutine forget_settling(run)
      class(block_simulation), intent(inout) :: run
      integer :: k, i
      associate (contacts => run%model%contacts, b => run%model%set%item)
         do k = 1, contacts%pairs
            do i = 1, 2
               associate (point => contacts%pair(k)%point(i))
                  point%dash_n = 0.0_wp
                  point%dash_s = 0.0_wp
                  point%friction_loss = 0.0_wp
                  point%damping_loss = 0.0_wp
               end associate
            end do
            contacts%pair(k)%loss_before = 0.0_wp
            contacts%pair(k)%support_work = 0.0_wp
         end do
         contacts%friction_loss = 0.0_wp
         contacts%damping_loss = 0.0_wp
         contacts%joint_loss = 0.0_wp
         contacts%support_work = 0.0_wp
         call forget_tie_losses(run%model%ties)
         b%work = 0.0_wp
         b%mass_loss = 0.0_wp
         b%bounces = 0
         b%airborne = 0.0_wp
      end associate
   end subroutine forget_settling

   subroutine record_state(run)
      class(block_simulation), intent(inout) :: run
      integer :: k
      real(wp) :: half
      associate (model => run%model, place => run%record%place(:, :, run%record%points), &
                 rate => run%record%rate(:, :, run%record%points))
         half = 0.5_wp * model%drift
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               place(:, k) = [b%x - model%drift * b%vx, b%y - model%drift * b%vy, b%angle - model%drift * b%spin]
               rate(:, k) = [b%vx, b%vy, b%spin]
               if (.not. b%fixed) rate(:, k) = rate(:, k) &
                  - half * [b%fx / b%mass + model%pull(1), b%fy / b%mass + model%pull(2), b%moment / b%inertia]
            end associate
            place(1:2, k) = place(1:2, k) - (model%base_place - model%drift * model%base)
            rate(1:2, k) = rate(1:2, k) - model%base
         end do
      end associate
      call record_joints(run%model%set, run%model%contacts, run%record%joint(:, :, run%record%points))
      if (count_places(run%model%places) > 0) call record_places(run%model%set, run%model%contacts, run%model%places, &
         run%record%press(:, :, run%record%points))
   end subroutine record_state

   !> Forces of the joints in the last step, and the energy that they have dissipated
   pure subroutine record_joints(set, contacts, joint)
      type(body_set), intent(in) :: set
      type(contact_set), intent(in) :: contacts
      real(wp), intent(out) :: joint(:, :)          !! (5, joints) on the first body: x, y [N], 0; friction, dashpots [J]
      type(overlap) :: now
      real(wp) :: force(2), normal, shear
      integer :: k, i
      joint(1:3, :) = 0.0_wp
      joint(4:5, :) = contacts%joint_loss
      do k = 1, contacts%pairs
         associate (pair => contacts%pair(k))
            if (pair%joint == 0) cycle
            call measure_overlap(pair, set%item(pair%bodies(1)), set%item(pair%bodies(2)), now)
            force = 0.0_wp
            do i = 1, 2
               if (.not. pair%point(i)%closed) cycle
               normal = pair%point(i)%spring_n + pair%point(i)%dash_n
               shear = pair%point(i)%spring_s + pair%point(i)%dash_s
               force = force + [normal * now%ty(i) + shear * now%tx(i), shear * now%ty(i) - normal * now%tx(i)]
            end do
            ! The forces of points are those on the second body.
            if (pair%bodies(1) < pair%bodies(2)) force = -force
            joint(1:2, pair%joint) = joint(1:2, pair%joint) + force
            joint(4:5, pair%joint) = joint(4:5, pair%joint) + pair_loss(pair)
         end associate
      end do
   end subroutine record_joints

   !> Forces of the contacts as drawn in the last step, and their places
   pure subroutine record_places(set, contacts, places, press)
      type(body_set), intent(in) :: set
      type(contact_set), intent(in) :: contacts
      type(place_table), intent(in) :: places
      real(wp), intent(out) :: press(:, :)          !! see dem_places
      type(overlap) :: now
      real(wp) :: normal, shear, way(2), force(2), at(2)
      integer :: k, i
      press = 0.0_wp
      do k = 1, contacts%pairs
         associate (pair => contacts%pair(k))
            if (pair%joint == 0) cycle
            call measure_overlap(pair, set%item(pair%bodies(1)), set%item(pair%bodies(2)), now)
            associate (low => set%item(minval(pair%bodies)))
               do i = 1, 2
                  if (.not. pair%point(i)%closed) cycle
                  normal = pair%point(i)%spring_n + pair%point(i)%dash_n
                  shear = pair%point(i)%spring_s + pair%point(i)%dash_s
                  way = [now%ty(i), -now%tx(i)]
                  force = normal * way + shear * [now%tx(i), now%ty(i)]
                  ! The forces of points are those on the second body.
                  if (pair%bodies(1) < pair%bodies(2)) force = -force
                  at = [now%x(i) - low%x, now%y(i) - low%y]
                  call add_force(places, pair%joint, own_axes(low, at), own_axes(low, way), [force, 0.0_wp], &
                     pair%point(i)%spring_n, press)
               end do
            end associate
         end associate
      end do
   end subroutine record_places

   !> A vector of the plane in the axes of a body
   pure function own_axes(b, v) result(own)
      type(body), intent(in) :: b
      real(wp), intent(in) :: v(2)
      real(wp) :: own(3)
      own = [b%c * v(1) + b%s * v(2), b%c * v(2) - b%s * v(1), 0.0_wp]
   end function own_axes

   function list_sizes(run) result(told)
      class(block_simulation), intent(in) :: run
      integer(c_int64_t) :: told(model_sizes)
      type(body) :: one
      type(contact_pair) :: pair
      associate (set => run%model%set, contacts => run%model%contacts)
         told = int([storage_size(one), storage_size(pair), size(set%item), size(set%parts), size(contacts%pair), &
            size(contacts%spare), size(contacts%sequence), size(contacts%colour_first)], c_int64_t)
      end associate
   end function list_sizes

   subroutine allocate_state(run, sizes, most, status)
      class(block_simulation), intent(inout) :: run
      integer(c_int64_t), intent(in) :: sizes(model_sizes)
      integer(c_int64_t), intent(in) :: most
      integer(c_int), intent(out) :: status
      integer :: parts, failed
      status = status_invalid_argument
      if (any(sizes(5:8) < 0) .or. any(sizes(5:8) > most)) return
      parts = size(run%model%set%parts)
      associate (contacts => run%model%contacts)
         allocate (contacts%pair(sizes(5)), contacts%spare(sizes(6)), contacts%row(parts + 1), &
            contacts%sequence(sizes(7)), contacts%sweep(parts), contacts%box(4, parts), &
            contacts%used(size(run%model%set%item)), contacts%colour_first(sizes(8)), stat=failed)
      end associate
      status = merge(status_ok, status_out_of_memory, failed == 0)
   end subroutine allocate_state

   subroutine walk_state(run, on, status)
      class(block_simulation), intent(inout), target :: run
      type(tape), intent(inout) :: on
      integer(c_int), intent(out) :: status
      status = status_ok
      associate (model => run%model, contacts => run%model%contacts)
         call on%pass(model%set%item, storage_size(model%set%item))
         call on%pass(model%pull, storage_size(model%pull))
         call on%pass(model%pull_before, storage_size(model%pull_before))
         call on%pass(model%base, storage_size(model%base))
         call on%pass(model%base_place, storage_size(model%base_place))
         call on%pass(contacts%pairs, storage_size(contacts%pairs))
         call on%pass(contacts%pair, storage_size(contacts%pair))
         call on%pass(contacts%row, storage_size(contacts%row))
         call on%pass(contacts%sequence, storage_size(contacts%sequence))
         call on%pass(contacts%colours, storage_size(contacts%colours))
         call on%pass(contacts%alone, storage_size(contacts%alone))
         call on%pass(contacts%colour_first, storage_size(contacts%colour_first))
         call on%pass(contacts%sweep, storage_size(contacts%sweep))
         call on%pass(contacts%box, storage_size(contacts%box))
         call on%pass(contacts%used, storage_size(contacts%used))
         call on%pass(contacts%skin, storage_size(contacts%skin))
         call on%pass(contacts%friction_loss, storage_size(contacts%friction_loss))
         call on%pass(contacts%damping_loss, storage_size(contacts%damping_loss))
         call on%pass(contacts%support_work, storage_size(contacts%support_work))
         call on%pass(contacts%joint_loss, storage_size(contacts%joint_loss))
      end associate
   end subroutine walk_state

end module dem_plane_run
